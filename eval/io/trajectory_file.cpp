// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/trajectory_file.h"

#include <cstdio>
#include <vector>

#include "core/base/error.h"
#include "eval/io/pose_row.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {

LoadedTrajectory read_tum(const std::filesystem::path& file, const std::string& frame) {
  return parse_tum(read_text_file(file), file.string(), frame);
}

LoadedTrajectory parse_tum(std::string_view text, const std::string& name, const std::string& frame) {
  LoadedTrajectory loaded;
  loaded.trajectory.frame = frame;
  LineReader lines(text);
  std::vector<std::string_view> fields;
  while (const std::optional<std::string_view> line = lines.next()) {
    split_fields(*line, fields);
    if (fields.empty() || fields.front().front() == '#') continue;
    const RowLocation location{name, lines.line_number()};
    if (fields.size() < 8) {
      throw location.error("a pose needs 8 numbers, found " + std::to_string(fields.size()) +
                           "; expected \"t tx ty tz qx qy qz qw\"");
    }
    const Timestamp t = require_stamp(fields[0], location);
    append_row(loaded, t, parse_pose(std::span(fields).subspan(1, 7), QuaternionOrder::kXyzw, location),
               location);
  }
  require_poses(loaded, name);
  return loaded;
}

void write_tum(const Trajectory& trajectory, const std::filesystem::path& file) {
  write_text_file(file, format_tum(trajectory));
}

std::string format_tum(const Trajectory& trajectory) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  text.reserve(text.size() + 110 * trajectory.poses.size());
  char row[320];
  for (const auto& [t, pose] : trajectory.poses) {
    const int length = std::snprintf(row, sizeof row, " %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", pose.p.x(),
                                     pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w());
    STILLPOINT_CHECK(length > 0 && length < static_cast<int>(sizeof row));
    text += format_stamp(t);
    text.append(row, static_cast<std::size_t>(length));
  }
  return text;
}

}  // namespace stillpoint::eval
