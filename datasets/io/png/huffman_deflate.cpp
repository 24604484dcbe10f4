// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/png/huffman_deflate.h"

#include <isa-l/igzip_lib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <queue>
#include <utility>

namespace stillpoint::datasets {
namespace {

static_assert(std::endian::native == std::endian::little);  // the order of bytes in a stream

constexpr std::size_t kSymbols = 257;        // the bytes, and the end of the block
constexpr std::uint32_t kLongest_bits = 14;  // four codes and a part of a byte fit in 64 bits
constexpr std::uint64_t kFewest_bits = 3;    // per byte, in the mean
constexpr std::size_t kSampled = 1024;       // bytes that are counted of each kPeriod
constexpr std::size_t kPeriod = 4 * kSampled;
constexpr std::size_t kOverhead = 1024;  // more than the head and the end of a stream

template <class T>
using PerSymbol = std::array<T, kSymbols>;

/// Of a part of the bytes; at least 1, so that each has a code.
PerSymbol<std::uint32_t> count(std::span<const unsigned char> bytes) {
  std::array<PerSymbol<std::uint32_t>, 4> counts{};  // equal bytes in a row do not wait for each other
  for (std::size_t first = 0; first < bytes.size(); first += kPeriod) {
    const std::size_t end = std::min(first + kSampled, bytes.size());
    for (std::size_t i = first; i < end; ++i) ++counts[i % counts.size()][bytes[i]];
  }
  PerSymbol<std::uint32_t> sum;
  for (std::size_t i = 0; i < kSymbols; ++i)
    sum[i] = 1 + counts[0][i] + counts[1][i] + counts[2][i] + counts[3][i];
  return sum;
}

/// Lengths of an optimal code (Huffman 1952) [bits].
PerSymbol<std::uint32_t> optimal_lengths(const PerSymbol<std::uint32_t>& counts) {
  using Node = std::pair<std::uint64_t, std::size_t>;  // count and number: symbols, then pairs of nodes
  std::priority_queue<Node, std::vector<Node>, std::greater<>> left;
  for (std::size_t i = 0; i < kSymbols; ++i) left.emplace(counts[i], i);
  std::array<std::size_t, 2 * kSymbols> parent{};
  std::size_t nodes = kSymbols;
  for (; left.size() > 1; ++nodes) {
    std::uint64_t sum = 0;
    for (int child = 0; child < 2; ++child) {
      sum += left.top().first;
      parent[left.top().second] = nodes;
      left.pop();
    }
    left.emplace(sum, nodes);
  }
  std::array<std::uint32_t, 2 * kSymbols> depth{};
  for (std::size_t node = nodes - 1; node-- > 0;) depth[node] = depth[parent[node]] + 1;
  PerSymbol<std::uint32_t> lengths;
  std::copy_n(depth.begin(), kSymbols, lengths.begin());
  return lengths;
}

/// Of at most `kLongest_bits`: rare symbols are taken for more frequent ones.
PerSymbol<std::uint32_t> code_lengths(PerSymbol<std::uint32_t> counts) {
  for (;;) {
    const PerSymbol<std::uint32_t> lengths = optimal_lengths(counts);
    if (*std::ranges::max_element(lengths) <= kLongest_bits) return lengths;
    for (std::uint32_t& one : counts) one = one / 2 + 1;
  }
}

struct Code {
  std::uint32_t bits, length;
};

std::uint32_t reversed(std::uint32_t bits, std::uint32_t length) {
  std::uint32_t result = 0;
  for (std::uint32_t i = 0; i < length; ++i) result |= (bits >> i & 1U) << (length - 1 - i);
  return result;
}

/// RFC 1951, Sec. 3.2.2: codes of equal length ascend with the symbol.
PerSymbol<Code> codes_of(const PerSymbol<std::uint32_t>& lengths) {
  PerSymbol<Code> codes{};
  std::uint32_t next = 0;
  for (std::uint32_t length = 1; length <= kLongest_bits; ++length, next <<= 1U) {
    for (std::size_t i = 0; i < kSymbols; ++i) {
      if (lengths[i] == length) codes[i] = {reversed(next++, length), length};
    }
  }
  return codes;
}

class BitWriter {
 public:
  explicit BitWriter(unsigned char* out) : out_(out) {}

  /// At most 56 bits between two calls of `flush`.
  void add(std::uint64_t bits, std::uint32_t count) {
    bits_ |= bits << count_;
    count_ += count;
  }
  void add(const Code& code) { add(code.bits, code.length); }

  /// Writes whole bytes. @return the end of what is written
  unsigned char* flush() {
    std::memcpy(out_, &bits_, sizeof bits_);
    out_ += count_ / 8;
    bits_ >>= count_ & ~7U;
    count_ &= 7U;
    return out_;
  }

  /// Fills the last byte. @return as `flush`
  unsigned char* end() {
    count_ += 7;
    return flush();
  }

 private:
  unsigned char* out_;
  std::uint64_t bits_ = 0;
  std::uint32_t count_ = 0;
};

/// RFC 1951, Sec. 3.2.7: the only block, with the lengths of its codes, each as a number of four bits.
void write_head(const PerSymbol<std::uint32_t>& lengths, BitWriter& writer) {
  constexpr int kLengthCodes = 19, kNotUsed = 3;  // the first ones are those of repeated lengths
  constexpr std::uint32_t kBitsOfLength = 4;
  writer.add(0b101, 3);                // last block, dynamic codes
  writer.add(0, 5), writer.add(0, 5);  // 257 symbols, one distance
  writer.add(kLengthCodes - 4, 4);
  for (int i = 0; i < kLengthCodes; ++i) {
    writer.add(i < kNotUsed ? 0 : kBitsOfLength, 3);
    writer.flush();
  }
  for (const std::uint32_t length : lengths) {
    writer.add(reversed(length, kBitsOfLength), kBitsOfLength);
    writer.flush();
  }
  writer.add(reversed(1, kBitsOfLength), kBitsOfLength);  // of the distance, which is not used
  writer.flush();
}

}  // namespace

std::optional<std::vector<unsigned char>> huffman_deflate(std::span<const unsigned char> bytes) {
  const PerSymbol<std::uint32_t> counts = count(bytes), lengths = code_lengths(counts);
  std::uint64_t counted = 0, bits = 0;
  for (std::size_t i = 0; i < kSymbols; ++i)
    counted += counts[i], bits += std::uint64_t{counts[i]} * lengths[i];
  if (bits < kFewest_bits * counted) return std::nullopt;
  const PerSymbol<Code> codes = codes_of(lengths);
  const auto out =
      std::make_unique_for_overwrite<unsigned char[]>(bytes.size() * kLongest_bits / 8 + kOverhead);
  out[0] = 0x78, out[1] = 0x01;  // deflate in a window of 32 kB, fastest
  BitWriter writer(out.get() + 2);
  write_head(lengths, writer);
  const std::size_t whole = bytes.size() / 4 * 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    for (std::size_t j = i; j < i + 4; ++j) writer.add(codes[bytes[j]]);
    writer.flush();
  }
  for (const unsigned char byte : bytes.subspan(whole)) writer.add(codes[byte]);
  writer.flush();
  writer.add(codes.back());
  unsigned char* end = writer.end();
  const std::uint32_t checksum = isal_adler32(1, bytes.data(), bytes.size());
  for (int shift = 24; shift >= 0; shift -= 8) *end++ = static_cast<unsigned char>(checksum >> shift);
  return std::vector<unsigned char>(out.get(), end);
}

}  // namespace stillpoint::datasets
