// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/png/huffman_deflate.h"

#include <gtest/gtest.h>
#include <isa-l/igzip_lib.h>

#include <cstdint>
#include <vector>

namespace stillpoint::datasets {
namespace {

using Bytes = std::vector<unsigned char>;

/// Of `kinds` different values.
Bytes noise(std::size_t size, std::uint32_t kinds) {
  Bytes bytes(size);
  std::uint32_t state = 1;
  for (unsigned char& byte : bytes) {
    state = state * 1664525U + 1013904223U;
    byte = static_cast<unsigned char>((state >> 16) % kinds);
  }
  return bytes;
}

/// By ISA-L, which verifies the checksum. @return empty if the stream is damaged
Bytes decompressed(Bytes stream, std::size_t size) {
  Bytes out(size + 1);
  inflate_state state;
  isal_inflate_init(&state);
  state.crc_flag = ISAL_ZLIB;
  state.next_in = stream.data(), state.avail_in = static_cast<std::uint32_t>(stream.size());
  state.next_out = out.data(), state.avail_out = static_cast<std::uint32_t>(out.size());
  if (isal_inflate(&state) != ISAL_DECOMP_OK || state.block_state != ISAL_BLOCK_FINISH) return {};
  out.resize(state.total_out);
  return out;
}

TEST(HuffmanDeflate, NoiseOfAnyLengthIsKept) {
  for (const std::size_t size : {1, 2, 3, 4, 5, 8, 1000, 5000, 100001}) {
    const Bytes bytes = noise(size, 256);
    const auto stream = huffman_deflate(bytes);
    ASSERT_TRUE(stream);
    EXPECT_EQ(decompressed(*stream, size), bytes) << size;
  }
}

TEST(HuffmanDeflate, ItsSizeIsThatOfTheEntropy) {
  const Bytes bytes = noise(400000, 32);
  const auto stream = huffman_deflate(bytes);
  ASSERT_TRUE(stream);
  EXPECT_LT(stream->size(), 252000U);  // 5 bits for each, and a code for those that do not occur
}

TEST(HuffmanDeflate, BytesThatHardlyOccurAreKept) {
  Bytes bytes = noise(800000, 64);  // the optimal codes of other bytes have more bits than are allowed
  for (std::size_t i = 0; i < 256; ++i) bytes[2000 + 4096 * (i % 190) + i] = static_cast<unsigned char>(i);
  const auto stream = huffman_deflate(bytes);
  ASSERT_TRUE(stream);
  EXPECT_EQ(decompressed(*stream, bytes.size()), bytes);
}

TEST(HuffmanDeflate, RepetitionsAreLeftToOthers) {
  EXPECT_FALSE(huffman_deflate(Bytes(10000, 7)));
  EXPECT_FALSE(huffman_deflate(noise(10000, 4)));
}

}  // namespace
}  // namespace stillpoint::datasets
