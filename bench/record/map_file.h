// SPDX-License-Identifier: BSD-3-Clause
/// Files of `run --save-map` and `--map`.
///
///   "stillmap"                       8 bytes
///   version, number of keyframes     uint32 each
///   keyframes                        frame int64, t [ns] int64, T_m_b and T_b_c (7 doubles each: p, then q
///   as
///                                    x y z w), gravity (3 doubles, NaN = none), number of features uint32,
///                                    features (4 uint64 of the descriptor, 3 floats of the point)
///   checksum                         XXH64 of all bytes before it, uint64
///
/// All little endian; 22 kB for a keyframe of 500 features.
#pragma once

#include <filesystem>
#include <string>

#include "core/types/loop_report.h"

namespace stillpoint::bench {

inline constexpr const char* kMapMagic = "stillmap";

[[nodiscard]] std::string map_bytes(const KeyframeMap& map);

/// Checksum of the file that contains a map: sixteen hexadecimal digits.
[[nodiscard]] std::string map_checksum(const KeyframeMap& map);

/// @param name of the file, for messages
/// @throws InputError if the bytes are not a map, of another version, or damaged
[[nodiscard]] KeyframeMap parse_map(const std::string& bytes, const std::string& name);

/// `parse_map` for a file. @throws InputError in addition if it cannot be read
[[nodiscard]] KeyframeMap read_map(const std::filesystem::path& file);

}  // namespace stillpoint::bench
