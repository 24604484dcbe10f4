// SPDX-License-Identifier: BSD-3-Clause
/// Parsing of one row of a trajectory file; common to all text formats.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::eval {

/// Position of a row in its file, for error messages.
struct RowLocation {
  const std::string& file;
  long line;

  [[nodiscard]] InputError error(const std::string& problem) const { return {file, line, problem}; }
};

enum class QuaternionOrder { kXyzw, kWxyz };

/// Parses a time stamp in seconds.
/// @throws InputError if the field is not a number of seconds, with a hint if it may be in nanoseconds
[[nodiscard]] Timestamp require_stamp(std::string_view field, const RowLocation& location);

/// Parses the seven fields `tx ty tz` + quaternion and normalizes the quaternion.
/// @return nullopt if the row has no pose (a value that is not finite, or a zero quaternion)
/// @throws InputError if a field is not a number, or if the norm of the quaternion differs from 1 by more
/// than 0.1
[[nodiscard]] std::optional<Pose> parse_pose(std::span<const std::string_view> fields, QuaternionOrder order,
                                             const RowLocation& location);

/// Appends a row, or counts it as skipped if it has no pose.
/// @throws InputError if the stamp does not increase
void append_row(LoadedTrajectory& loaded, Timestamp t, const std::optional<Pose>& pose,
                const RowLocation& location);

/// @throws InputError if no pose was loaded
void require_poses(const LoadedTrajectory& loaded, const std::string& file);

}  // namespace stillpoint::eval
