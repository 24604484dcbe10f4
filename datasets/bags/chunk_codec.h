// SPDX-License-Identifier: BSD-3-Clause
/// Compression of the chunks of bags. The only component that depends on bzip2, LZ4 and zstd.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "datasets/bags/bag_index.h"

namespace stillpoint::datasets {

/// Largest size of a decompressed chunk.
inline constexpr std::uint64_t kMaxChunkBytes = 1'000'000'000;

/// Writers close a chunk that has reached this size, the default of rosbag; one message may be larger.
inline constexpr std::size_t kWrittenChunkBytes = 768 * 1024;

/// The method with this name in a bag: none or "", bz2, lz4, zstd.
[[nodiscard]] std::optional<ChunkCompression> compression_of(std::string_view name);

/// Inverse of `compression_of`.
[[nodiscard]] std::string_view name_of(ChunkCompression compression);

/// Decompresses a chunk: a bzip2 stream, LZ4 frames, or zstd frames. The memory grows with the decompressed
/// bytes, not with the expected number.
/// @param bytes expected size after decompression
/// @param place for errors
/// @throws InputError if the chunk is damaged, larger than `kMaxChunkBytes`, or has another size
[[nodiscard]] std::string decompress_chunk(ChunkCompression compression, std::string_view stored,
                                           std::uint64_t bytes, const std::string& place);

/// Inverse of `decompress_chunk`. LZ4 frames have independent blocks, as the decoder of ROS 1 requires.
[[nodiscard]] std::string compress_chunk(ChunkCompression compression, std::string_view bytes);

/// Decompresses zstd frames of unknown size; otherwise like `decompress_chunk`.
[[nodiscard]] std::string decompress_zstd(std::string_view stored, const std::string& place);

/// CRC-32 of zlib, ISO 3309.
[[nodiscard]] std::uint32_t crc32_of(std::string_view bytes, std::uint32_t previous = 0);

}  // namespace stillpoint::datasets
