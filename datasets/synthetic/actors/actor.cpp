// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/actors/actor.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "core/base/error.h"

namespace stillpoint::synth {
namespace {

constexpr int kSides = 12;
constexpr int kCapRings = 4;   // from pole to rim
constexpr int kTubeRings = 3;  // inner rings of the straight part

/// One ring of a limb: height, radius, and the z component of its normals.
struct Ring {
  double z, radius, lean;
};

std::vector<Ring> rings_of(const LimbShape& shape) {
  std::vector<Ring> rings;
  for (int i = 0; i <= kCapRings; ++i) {
    const double angle = 0.5 * std::numbers::pi * (1.0 - static_cast<double>(i) / kCapRings);
    rings.push_back(
        {0.7 * shape.top_radius_m * std::sin(angle), shape.top_radius_m * std::cos(angle), std::sin(angle)});
  }
  for (int i = 1; i <= kTubeRings; ++i) {
    const double fraction = static_cast<double>(i) / (kTubeRings + 1);
    rings.push_back(
        {-shape.length_m * fraction, std::lerp(shape.top_radius_m, shape.bottom_radius_m, fraction), 0.0});
  }
  for (int i = 0; i <= kCapRings; ++i) {
    const double angle = 0.5 * std::numbers::pi * static_cast<double>(i) / kCapRings;
    rings.push_back({-shape.length_m - 0.7 * shape.bottom_radius_m * std::sin(angle),
                     shape.bottom_radius_m * std::cos(angle), -std::sin(angle)});
  }
  return rings;
}

void add_face(RigidPart& part, const Eigen::Vector3d& corner, const Eigen::Vector3d& right,
              const Eigen::Vector3d& down) {
  const auto first = static_cast<std::uint32_t>(part.points.size());
  const Eigen::Vector3f normal = right.cross(-down).normalized().cast<float>();
  for (int i = 0; i < 4; ++i) {
    const double u = i == 1 || i == 2 ? 1.0 : 0.0, v = i >= 2 ? 1.0 : 0.0;
    part.points.push_back((corner + u * right + v * down).cast<float>());
    part.normals.push_back(normal);
    part.uv.emplace_back(static_cast<float>(u), static_cast<float>(v));
  }
  part.triangles.push_back({first, first + 2, first + 1});
  part.triangles.push_back({first, first + 3, first + 2});
}

}  // namespace

RigidPart make_limb(const LimbShape& shape, int texture, double repeat_m, int texture_px) {
  RigidPart part;
  part.texture = texture;
  part.texels_per_m = static_cast<float>(texture_px / repeat_m);
  const std::vector<Ring> rings = rings_of(shape);
  const double repeats = 2.0 * std::numbers::pi * shape.top_radius_m / repeat_m;
  for (const Ring& ring : rings) {
    for (int side = 0; side <= kSides; ++side) {  // the vertices of the seam are duplicated
      const double angle = 2.0 * std::numbers::pi * side / kSides;
      const Eigen::Vector3d out(std::cos(angle) * shape.depth_ratio, std::sin(angle), 0.0);
      part.points.push_back((ring.radius * out + Eigen::Vector3d(0.0, 0.0, ring.z)).cast<float>());
      const Eigen::Vector3d normal(std::cos(angle) / shape.depth_ratio, std::sin(angle), 0.0);
      const double level = std::sqrt(1.0 - ring.lean * ring.lean);
      part.normals.push_back(
          (level * normal.normalized() + Eigen::Vector3d(0.0, 0.0, ring.lean)).cast<float>());
      part.uv.emplace_back(static_cast<float>(repeats * side / kSides),
                           static_cast<float>(-ring.z / repeat_m));
    }
  }
  constexpr std::uint32_t kRow = kSides + 1;
  for (std::uint32_t ring = 0; ring + 1 < rings.size(); ++ring) {
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t at = ring * kRow + side;
      part.triangles.push_back({at, at + kRow, at + kRow + 1});
      part.triangles.push_back({at, at + kRow + 1, at + 1});
    }
  }
  return part;
}

RigidPart make_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int texture, int texture_px) {
  RigidPart part;
  part.texture = texture;
  const Eigen::Vector3d size = high - low;
  part.texels_per_m = static_cast<float>(texture_px / std::cbrt(size.prod()));
  const Eigen::Vector3d x(size.x(), 0.0, 0.0), y(0.0, size.y(), 0.0), z(0.0, 0.0, size.z());
  add_face(part, low + z, x, -z);
  add_face(part, low + x + y + z, -x, -z);
  add_face(part, low + y + z, -y, -z);
  add_face(part, low + x + z, y, -z);
  add_face(part, low + y + z, x, -y);
  add_face(part, low, x, y);
  return part;
}

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
