// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/actors/unknown_movers.h"

#include <cmath>

namespace stillpoint::synth {
namespace {

using Eigen::Vector3d;
constexpr int kFine_px = 512, kPlain_px = 256;

/// Poses of `count` parts that form one rigid body.
std::vector<Pose> rigid_poses(const Walk& walk, double t_s, double extra_turn, std::size_t count) {
  const Walk::State state = walk.at(t_s);
  const Eigen::AngleAxisd turn(state.heading + extra_turn, Vector3d::UnitZ());
  return {count, Pose{Eigen::Quaterniond(turn), {state.position.x(), state.position.y(), 0.0}}};
}

void add_wheels(std::vector<RigidPart>& parts, double x, double y, int texture) {
  for (const double side_x : {-x, x}) {
    for (const double side_y : {-y, y}) {
      parts.push_back(make_box({side_x - 0.05, side_y - 0.02, 0.0}, {side_x + 0.05, side_y + 0.02, 0.1},
                               texture, kPlain_px));
    }
  }
}

}  // namespace

Actor make_cart(const Palette& palette, int object, const Walk& walk, std::uint64_t random_key) {
  RandomSequence random(random_key);
  Actor actor{.object = object, .class_name = "cart", .parts = {}, .poses_at = {}};
  std::vector<RigidPart>& parts = actor.parts;
  add_wheels(parts, 0.35, 0.22, palette.dark_plastic);
  parts.push_back(make_box({-0.45, -0.3, 0.1}, {0.45, 0.3, 0.16}, palette.metal, kPlain_px));
  for (const double y : {-0.28, 0.25}) {
    parts.push_back(make_box({-0.45, y, 0.16}, {-0.41, y + 0.03, 1.0}, palette.metal, kPlain_px));
  }
  parts.push_back(make_box({-0.46, -0.28, 0.97}, {-0.41, 0.28, 1.02}, palette.dark_plastic, kPlain_px));
  const double height = random.uniform(0.3, 0.42);
  parts.push_back(make_box({-0.38, -0.27, 0.16}, {0.05, 0.27, 0.16 + height}, palette.carton, kFine_px));
  parts.push_back(
      make_box({0.08, -0.25, 0.16}, {0.42, 0.22, 0.5}, pick_random(palette.packages, random), 2 * kFine_px));
  parts.push_back(make_box({-0.33, -0.2, 0.16 + height}, {0.02, 0.18, 0.45 + height},
                           pick_random(palette.packages, random), 2 * kFine_px));
  actor.poses_at = [walk, count = parts.size()](double t_s) { return rigid_poses(walk, t_s, 0.0, count); };
  return actor;
}

Actor make_rolling_chair(const Palette& palette, int object, const Walk& walk, std::uint64_t random_key) {
  RandomSequence random(random_key);
  Actor actor{.object = object, .class_name = "chair", .parts = {}, .poses_at = {}};
  std::vector<RigidPart>& parts = actor.parts;
  const int fabric = pick_random(palette.fabrics, random);
  add_wheels(parts, 0.2, 0.2, palette.dark_plastic);
  parts.push_back(make_box({-0.25, -0.03, 0.06}, {0.25, 0.03, 0.1}, palette.dark_plastic, kPlain_px));
  parts.push_back(make_box({-0.03, -0.25, 0.065}, {0.03, 0.25, 0.105}, palette.dark_plastic, kPlain_px));
  parts.push_back(make_box({-0.03, -0.03, 0.1}, {0.03, 0.03, 0.43}, palette.metal, kPlain_px));
  parts.push_back(make_box({-0.24, -0.24, 0.43}, {0.24, 0.24, 0.5}, fabric, kFine_px));
  parts.push_back(make_box({-0.25, -0.21, 0.58}, {-0.19, 0.21, 1.0}, fabric, kFine_px));
  parts.push_back(make_box({-0.2, -0.13, 0.503}, {0.12, 0.12, 0.56}, pick_random(palette.packages, random),
                           2 * kFine_px));
  actor.poses_at = [walk, count = parts.size()](double t_s) {
    return rigid_poses(walk, t_s, 0.5 * std::sin(0.5 * walk.at(t_s).distance_m), count);
  };
  return actor;
}

}  // namespace stillpoint::synth
