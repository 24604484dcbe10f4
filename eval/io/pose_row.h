// SPDX-License-Identifier: BSD-3-Clause
/// One row of a trajectory file: what all text formats share.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint {

/// Where a row stands, for messages.
struct RowPlace {
  const std::string& file;
  long line;

  [[nodiscard]] InputError error(const std::string& problem) const { return {file, line, problem}; }
};

enum class QuaternionOrder { kXyzw, kWxyz };

/// The stamp in seconds of one field.
/// @throws InputError if the field is no number of seconds, with a hint when it looks like nanoseconds
[[nodiscard]] Timestamp require_stamp(std::string_view field, const RowPlace& place);

/// Position and quaternion, brought to unit length, of seven fields `tx ty tz` + quaternion; nothing if the
/// row holds no pose (a value that is not finite, or a quaternion of length zero).
/// @throws InputError if a field is no number, or if the quaternion's length is off by more than 10 %
[[nodiscard]] std::optional<Pose> parse_pose(std::span<const std::string_view> fields, QuaternionOrder order,
                                             const RowPlace& place);

/// Adds a row to what was loaded, or counts it as skipped.
/// @throws InputError if the stamp does not rise
void append_row(LoadedTrajectory& loaded, Timestamp t, const std::optional<Pose>& pose,
                const RowPlace& place);

/// @throws InputError if nothing was loaded
void require_poses(const LoadedTrajectory& loaded, const std::string& file);

}  // namespace stillpoint
