// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/actors/movers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/materials/surfaces.h"

namespace stillpoint::synth {
namespace {

constexpr double kStep_s = 0.01;
constexpr double kAcceleration = 1.2;   // [m/s^2]
constexpr double kRetreatRatio = 0.75;  // of the camera clearance: closer than this, retreat
constexpr double kLookAhead_m = 0.4;

/// Heading averaged over +-0.2 m of the route, for smooth turns.
double heading_at(const ClosedRoute& route, double distance_m) {
  double sum = 0.0;
  for (int i = -2; i <= 2; ++i) sum += route.at(distance_m + 0.1 * i).heading;
  return sum / 5.0;
}

}  // namespace

Walk::Walk(const ClosedRoute& route, const WalkStyle& style, const CameraMotion& camera_motion,
           std::uint64_t random_key)
    : route_(route), nominal_speed_(style.speed), from_s_(camera_motion.from_s) {
  const auto& [camera_at, from_s, to_s] = camera_motion;
  RandomSequence random(random_key);
  double distance = style.start_m, speed = style.speed, stop_until_s = from_s;
  for (double t_s = from_s; t_s < to_s + kStep_s; t_s += kStep_s) {
    steps_.push_back({distance, speed});
    if (random.chance(style.stops_per_minute / 60.0 * kStep_s)) {
      stop_until_s = t_s + style.stop_s * random.uniform(0.5, 1.5);
    }
    const Eigen::Vector2d camera = camera_at(t_s);
    const double ahead = (route_.at(distance + kLookAhead_m).position - camera).norm();
    const double here = (route_.at(distance).position - camera).norm();
    const double back = (route_.at(distance - kLookAhead_m).position - camera).norm();
    double target_speed = t_s < stop_until_s ? 0.0 : style.speed;
    if (std::min(here, ahead) < style.camera_clearance_m && ahead < here) target_speed = 0.0;
    if (here < kRetreatRatio * style.camera_clearance_m)
      target_speed = (back > ahead ? -1.0 : 1.0) * style.speed;
    speed += std::clamp(target_speed - speed, -kAcceleration * kStep_s, kAcceleration * kStep_s);
    distance += speed * kStep_s;
  }
}

Walk::State Walk::at(double t_s) const {
  const double step = std::clamp((t_s - from_s_) / kStep_s, 0.0, static_cast<double>(steps_.size()) - 1.001);
  const auto index = static_cast<std::size_t>(step);
  const double fraction = step - std::floor(step);
  const double distance = std::lerp(steps_[index].distance_m, steps_[index + 1].distance_m, fraction);
  const double speed = std::lerp(steps_[index].speed, steps_[index + 1].speed, fraction);
  return {route_.at(distance).position, heading_at(route_, distance), distance,
          std::min(1.0, std::abs(speed) / nominal_speed_)};
}

namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
// Segment lengths of a person of 1.75 m, rounded from Winter (2009), table 4.1.
constexpr double kThigh_m = 0.43, kShank_m = 0.42, kFoot_m = 0.08;
constexpr double kUpperArm_m = 0.31, kForearm_m = 0.26;
constexpr double kHipHalf_m = 0.09, kShoulderHalf_m = 0.21, kShoulder_m = 0.47;  // above the hip center
constexpr double kStride_m = 1.35;                                               // two steps
constexpr double kSeat_m = 0.58;                                                 // hip height when seated

/// Angles of all joints [rad]; forward is positive, index 0 is the left side.
struct Joints {
  double trunk_lean = 0.0, trunk_turn = 0.0, head_turn = 0.0;
  double hip[2] = {0.0, 0.0}, knee[2] = {0.0, 0.0};
  double shoulder[2] = {0.0, 0.0}, elbow[2] = {0.2, 0.2};
};

Pose pitch_forward(double angle) {
  return {Quaterniond(AngleAxisd(-angle, Vector3d::UnitY())), Vector3d::Zero()};
}
Pose yaw_left(double angle) { return {Quaterniond(AngleAxisd(angle, Vector3d::UnitZ())), Vector3d::Zero()}; }
Pose translation(double x, double y, double z) { return {Quaterniond::Identity(), {x, y, z}}; }

/// Poses of the parts in the frame of the hips (x forward, y left, z up), in the order of `make_body`.
std::vector<Pose> body_poses(const Joints& joints) {
  std::vector<Pose> poses;
  const Pose trunk = yaw_left(joints.trunk_turn) * pitch_forward(-joints.trunk_lean);
  const Pose neck = trunk * translation(0.01, 0.0, 0.68) * yaw_left(joints.head_turn);
  poses.push_back(trunk * translation(0.0, 0.0, 0.45));
  poses.push_back(translation(0.0, 0.0, 0.06));
  poses.push_back(neck * translation(0.0, 0.0, 0.09));
  poses.push_back(neck * translation(-0.012, 0.0, 0.11));
  poses.push_back(trunk * translation(0.0, 0.0, 0.66));
  for (int side = 0; side < 2; ++side) {
    const double left = side == 0 ? 1.0 : -1.0;
    const Pose outward{Quaterniond(AngleAxisd(0.1 * left, Vector3d::UnitX())), Vector3d::Zero()};
    const Pose upper_arm = trunk * translation(0.0, left * kShoulderHalf_m, kShoulder_m) *
                           pitch_forward(joints.shoulder[side]) * outward;
    const Pose forearm = upper_arm * translation(0.0, 0.0, -kUpperArm_m) * pitch_forward(joints.elbow[side]);
    const Pose thigh = translation(0.0, left * kHipHalf_m, 0.0) * pitch_forward(joints.hip[side]);
    const Pose shank = thigh * translation(0.0, 0.0, -kThigh_m) * pitch_forward(-joints.knee[side]);
    poses.push_back(upper_arm);
    poses.push_back(forearm);
    poses.push_back(forearm * translation(0.0, 0.0, -kForearm_m));
    poses.push_back(thigh);
    poses.push_back(shank);
    poses.push_back(shank * translation(-0.03, 0.0, -kShank_m) * pitch_forward(0.5 * kPi));
  }
  return poses;
}

/// Hip height at which the lower foot touches the floor.
double hip_height(const Joints& joints) {
  double height = 0.0;
  for (int side = 0; side < 2; ++side) {
    const double reach = kThigh_m * std::cos(joints.hip[side]) +
                         kShank_m * std::cos(joints.hip[side] - joints.knee[side]) + kFoot_m;
    height = std::max(height, reach);
  }
  return height;
}

/// Joint angles of walking: sinusoids with a bent knee in the swing phase (after Winter 2009, ch. 4).
Joints walking_joints(double distance_m, double pace) {
  const double phase = 2.0 * kPi * distance_m / kStride_m;
  Joints joints;
  joints.trunk_lean = 0.05 * pace;
  joints.trunk_turn = 0.08 * pace * std::sin(phase);
  for (int side = 0; side < 2; ++side) {
    const double side_phase = phase + (side == 0 ? 0.0 : kPi);
    const double swing = std::max(0.0, std::cos(side_phase + 0.5));
    joints.hip[side] = pace * (0.06 + 0.42 * std::sin(side_phase));
    joints.knee[side] = 0.06 + pace * (0.08 + 0.95 * swing * swing);
    joints.shoulder[side] = -0.38 * pace * std::sin(side_phase);
    joints.elbow[side] = 0.2 + pace * (0.15 + 0.15 * std::sin(side_phase + kPi));
  }
  return joints;
}

/// Joint angles of a seated person who types, leans and looks around; sinusoids of unrelated frequencies.
Joints seated_joints(double t_s, double phase) {
  Joints joints;
  joints.trunk_lean = 0.06 + 0.05 * std::sin(0.7 * t_s + phase);
  joints.trunk_turn = 0.08 * std::sin(0.45 * t_s + 2.0 * phase);
  joints.head_turn = 0.45 * std::sin(0.6 * t_s + 3.0 * phase);
  for (int side = 0; side < 2; ++side) {
    const double side_phase = phase + 1.3 * side;
    joints.hip[side] = 0.48 * kPi;
    joints.knee[side] = 0.5 * kPi;
    joints.shoulder[side] = 0.45 + 0.15 * std::sin(1.1 * t_s + side_phase);
    joints.elbow[side] = 1.15 + 0.3 * std::sin(1.7 * t_s + 2.0 * side_phase);
  }
  return joints;
}

struct Clothes {
  int shirt, trousers, skin, hair, shoes;
};

Clothes make_clothes(Builder& builder, RandomSequence& random) {
  const Color skins[] = {{222, 178, 150}, {196, 146, 112}, {150, 105, 78}, {112, 78, 60}};
  const Color hairs[] = {{52, 40, 32}, {92, 66, 40}, {150, 120, 70}, {120, 118, 116}};
  return {builder.add_texture(paint_clothes(random)),
          builder.add_texture(paint_fabric(random_color(random, random.uniform(55.0, 130.0), 0.45), random)),
          builder.add_texture(paint_plain(skins[random.index(4)], 6.0, random)),
          builder.add_texture(paint_plain(hairs[random.index(4)], 14.0, random)),
          builder.add_texture(paint_plain(random_color(random, 70.0, 0.3), 8.0, random))};
}

/// Trunk, hips, head, hair, neck; then for each side upper arm, forearm, hand, thigh, shank, foot.
std::vector<RigidPart> make_body(const Clothes& clothes) {
  constexpr int kCloth_px = 512, kPlain_px = 256;
  std::vector<RigidPart> parts;
  parts.push_back(make_limb({0.38, 0.19, 0.17, 0.65}, clothes.shirt, 0.6, kCloth_px));
  parts.push_back(make_limb({0.1, 0.145, 0.16, 0.68}, clothes.trousers, 0.5, kCloth_px));
  parts.push_back(make_limb({0.1, 0.085, 0.07, 1.1}, clothes.skin, 0.3, kPlain_px));
  parts.push_back(make_limb({0.04, 0.093, 0.09, 1.1}, clothes.hair, 0.3, kPlain_px));
  parts.push_back(make_limb({0.12, 0.055, 0.062, 1.0}, clothes.skin, 0.3, kPlain_px));
  for (int side = 0; side < 2; ++side) {
    parts.push_back(make_limb({kUpperArm_m, 0.058, 0.047, 1.0}, clothes.shirt, 0.6, kCloth_px));
    parts.push_back(make_limb({kForearm_m, 0.045, 0.034, 1.0}, clothes.shirt, 0.6, kCloth_px));
    parts.push_back(make_limb({0.09, 0.036, 0.03, 1.0}, clothes.skin, 0.3, kPlain_px));
    parts.push_back(make_limb({kThigh_m, 0.088, 0.062, 1.0}, clothes.trousers, 0.5, kCloth_px));
    parts.push_back(make_limb({kShank_m, 0.058, 0.043, 1.0}, clothes.trousers, 0.5, kCloth_px));
    parts.push_back(make_limb({0.15, 0.042, 0.045, 1.0}, clothes.shoes, 0.3, kPlain_px));
  }
  return parts;
}

std::vector<Pose> transformed(const Pose& T_w_hips, const Joints& joints) {
  std::vector<Pose> poses = body_poses(joints);
  for (Pose& pose : poses) pose = T_w_hips * pose;
  return poses;
}

}  // namespace

Actor make_walking_person(Builder& builder, int object, const Walk& walk, std::uint64_t random_key) {
  RandomSequence random(random_key);
  Actor actor{.object = object,
              .class_name = "person",
              .parts = make_body(make_clothes(builder, random)),
              .poses_at = {}};
  const double size = random.uniform(0.93, 1.06);
  for (RigidPart& part : actor.parts) {
    for (Eigen::Vector3f& point : part.points) point *= static_cast<float>(size);
  }
  actor.poses_at = [walk, size](double t_s) {
    const Walk::State state = walk.at(t_s);
    const Joints joints = walking_joints(state.distance_m / size, state.pace);
    const Vector3d hips(state.position.x(), state.position.y(), 0.0);
    std::vector<Pose> poses = body_poses(joints);
    const Pose T_w_floor = Pose{Quaterniond::Identity(), hips} * yaw_left(state.heading);
    for (Pose& pose : poses) {
      pose.p.z() += hip_height(joints);
      pose.p *= size;
      pose = T_w_floor * pose;
    }
    return poses;
  };
  return actor;
}

Actor make_seated_person(Builder& builder, int object, const Placement& seat, std::uint64_t random_key) {
  RandomSequence random(random_key);
  Actor actor{.object = object,
              .class_name = "person",
              .parts = make_body(make_clothes(builder, random)),
              .poses_at = {}};
  const double phase = random.uniform(0.0, 2.0 * kPi);
  // The front of a chair points to -y, that of the body to +x.
  const Pose T_w_hips = Pose{Quaterniond::Identity(), seat.position + Vector3d(0.0, 0.0, kSeat_m)} *
                        yaw_left(seat.yaw - 0.5 * kPi) * translation(-0.05, 0.0, 0.0);
  actor.poses_at = [T_w_hips, phase](double t_s) { return transformed(T_w_hips, seated_joints(t_s, phase)); };
  return actor;
}

namespace {

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
