// SPDX-License-Identifier: BSD-3-Clause
/// The text format of the OpenLORIS-Scene tools: header lines `key: value`, then one or more sequences.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "core/types/trajectory.h"

namespace stillpoint {

/// What one file holds. A sequence without poses is one that was tried and failed.
struct OpenlorisFile {
  std::string scene;  ///< "home", "cafe", ..., in lower case
  std::string frame;  ///< the frame that the poses are of, "base_link" where the file names none
  std::map<int, Trajectory> sequences;  ///< by number
  std::size_t skipped_rows = 0;         ///< NaN or zero quaternion
  std::size_t repeated_poses = 0;       ///< poses equal to the one before
};

enum class RepeatedPoses { kDrop, kKeep };

/// Reads `scene:`, `frame:` and `seq:` lines and poses: the stamp is the first column of a row, the pose its
/// last seven. Other header lines are passed over. A pose equal to the previous row's is dropped by default,
/// as the OpenLORIS tools do (their -k keeps it): systems that lose track repeat their last pose.
/// @throws InputError with file:line on a malformed row, a pose before the first `seq:`, or a sequence that
/// occurs twice
[[nodiscard]] OpenlorisFile read_openloris(const std::filesystem::path& file,
                                           RepeatedPoses repeated = RepeatedPoses::kDrop);

/// `read_openloris` on a text already in memory; `name` stands for the file in messages.
[[nodiscard]] OpenlorisFile parse_openloris(std::string_view text, const std::string& name,
                                            RepeatedPoses repeated = RepeatedPoses::kDrop);

/// The text of a file in this format.
[[nodiscard]] std::string format_openloris(const OpenlorisFile& file);

}  // namespace stillpoint
