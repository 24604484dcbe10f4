// SPDX-License-Identifier: BSD-3-Clause
/// Compression by a Huffman code of single bytes, without a search for repetitions: a valid stream of zlib
/// (RFC 1950, RFC 1951) for data that contain hardly any, as images with noise.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace stillpoint::datasets {

/// @return nullopt if the bytes need less than 3 bits each, so that repetitions would matter
[[nodiscard]] std::optional<std::vector<unsigned char>> huffman_deflate(std::span<const unsigned char> bytes);

}  // namespace stillpoint::datasets
