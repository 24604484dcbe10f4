// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/actors/actor.h"

#include "core/base/error.h"

namespace stillpoint::synth {
namespace {

/// Poses of a part at the start and the end of the frame's time interval.
struct PartMotion {
  const Pose& T_w_start;
  const Pose& T_w_end;
};

void add_part(MoverFrame& frame, const RigidPart& part, int object, const PartMotion& motion) {
  const auto& [T_w_start, T_w_end] = motion;
  const auto first = static_cast<std::uint32_t>(frame.mesh.start.size());
  const Eigen::Matrix3f R_start = T_w_start.R().cast<float>(), R_end = T_w_end.R().cast<float>();
  const Eigen::Vector3f p_start = T_w_start.p.cast<float>(), p_end = T_w_end.p.cast<float>();
  for (std::size_t i = 0; i < part.points.size(); ++i) {
    frame.mesh.start.push_back(R_start * part.points[i] + p_start);
    frame.mesh.end.push_back(R_end * part.points[i] + p_end);
    frame.normals.push_back(R_start * part.normals[i]);
  }
  for (const std::array<std::uint32_t, 3>& corners : part.triangles) {
    frame.mesh.triangles.push_back({first + corners[0], first + corners[1], first + corners[2]});
    frame.appearance.push_back({.object = object,
                                .texture = part.texture,
                                .uv = {part.uv[corners[0]], part.uv[corners[1]], part.uv[corners[2]]},
                                .texels_per_m = part.texels_per_m});
  }
}

}  // namespace

MoverFrame assemble_movers(std::span<const Actor> actors, double start_s, double end_s) {
  MoverFrame frame;
  for (const Actor& actor : actors) {
    const std::vector<Pose> start = actor.poses_at(start_s), end = actor.poses_at(end_s);
    STILLPOINT_CHECK(start.size() == actor.parts.size() && end.size() == actor.parts.size());
    for (std::size_t i = 0; i < actor.parts.size(); ++i) {
      add_part(frame, actor.parts[i], actor.object, {start[i], end[i]});
    }
  }
  return frame;
}

}  // namespace stillpoint::synth
