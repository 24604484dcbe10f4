// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/euroc_file.h"

#include <cstdio>
#include <vector>

#include "eval/io/pose_row.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {

LoadedTrajectory parse_euroc(std::string_view text, const std::string& name) {
  LoadedTrajectory loaded;
  LineReader lines(text);
  std::vector<std::string_view> fields;
  while (const std::optional<std::string_view> line = lines.next()) {
    split_fields(*line, fields);
    if (fields.empty() || fields.front().front() == '#') continue;
    const RowLocation location{name, lines.line_number()};
    if (fields.size() < 8) {
      throw location.error("a pose needs 8 numbers, found " + std::to_string(fields.size()) +
                           "; expected \"ns,px,py,pz,qw,qx,qy,qz\"");
    }
    const std::optional<Timestamp> t = parse_nanoseconds(fields[0]);
    if (!t)
      throw location.error("the stamp is not an integer number of nanoseconds; is the file in seconds?");
    append_row(loaded, *t, parse_pose(std::span(fields).subspan(1, 7), QuaternionOrder::kWxyz, location),
               location);
  }
  require_poses(loaded, name);
  return loaded;
}

std::string format_euroc(const Trajectory& trajectory) {
  std::string text =
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n";
  char row[360];
  for (const auto& [t, pose] : trajectory.poses) {
    std::snprintf(row, sizeof row, "%lld,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f\n", static_cast<long long>(t.ns),
                  pose.p.x(), pose.p.y(), pose.p.z(), pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z());
    text += row;
  }
  return text;
}

}  // namespace stillpoint::eval
