// SPDX-License-Identifier: BSD-3-Clause
/// Records of MCAP files: opcode (1 byte), length (8 bytes, little endian), fields. Specification:
/// mcap.dev/spec.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace stillpoint::datasets::mcap {

/// First and last bytes of a file.
inline constexpr std::string_view kMagic = "\x89MCAP0\r\n";
inline constexpr std::uint64_t kRecordHeadBytes = 9;  ///< opcode, length

enum Opcode : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kDataEnd = 15,
};

}  // namespace stillpoint::datasets::mcap
