// SPDX-License-Identifier: BSD-3-Clause
/// The text format of the OpenLORIS-Scene tools: header lines `key: value`, then one or more sequences.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "eval/io/trajectory_file.h"

namespace stillpoint::eval {

/// Contents of a file. A sequence without poses is a failed run.
struct OpenlorisFile {
  std::string scene;                    ///< "home", "cafe", ..., in lower case
  std::string frame;                    ///< body frame of the poses; "base_link" unless the file specifies it
  std::map<int, Trajectory> sequences;  ///< by number
  RowRepairs repairs;                   ///< of all sequences
  std::size_t repeated_poses = 0;       ///< dropped poses equal to the previous one
};

enum class RepeatedPoses { kDrop, kKeep };

/// Reads `scene:`, `frame:` and `seq:` lines and poses: the first column of a row is the stamp, the last
/// seven are the pose. Other header lines are ignored. A pose equal to that of the previous row is dropped by
/// default, as in the OpenLORIS tools (their option -k keeps it), because systems repeat their last pose when
/// tracking is lost.
/// @throws InputError with file:line for a malformed row, a pose before the first `seq:`, a duplicate
/// sequence, or a stamp out of order as in `read_tum`
[[nodiscard]] OpenlorisFile read_openloris(const std::filesystem::path& file,
                                           RepeatedPoses repeated = RepeatedPoses::kDrop);

/// `read_openloris` for a text in memory.
/// @param text contents of the file
/// @param name of the file, for error messages
/// @param repeated see `read_openloris`
[[nodiscard]] OpenlorisFile parse_openloris(std::string_view text, const std::string& name,
                                            RepeatedPoses repeated = RepeatedPoses::kDrop);

/// The text of a file in this format.
[[nodiscard]] std::string format_openloris(const OpenlorisFile& file);

}  // namespace stillpoint::eval
