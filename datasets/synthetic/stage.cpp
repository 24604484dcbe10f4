// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/stage.h"

#include <algorithm>
#include <cmath>

#include "datasets/synthetic/cast.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/flight.h"

namespace stillpoint {
namespace {

constexpr std::int64_t kEpoch_ns = 1700000000LL * 1000000000LL;
constexpr double kFirstFrame_s = 0.05;      // inertial readings begin this long before the first picture
constexpr double kTail_s = 0.05;            // and end this long after the last
constexpr double kTruthInterval_s = 0.005;  // 200 Hz
constexpr int kLongestDrop = 4;             // frames lost in one run, at most

HandMotion hand_motion_of(const std::string& preset) {
  if (preset.starts_with("walking_static")) return HandMotion::kStatic;
  if (preset.starts_with("walking_rpy")) return HandMotion::kRpy;
  if (preset.starts_with("walking_halfsphere")) return HandMotion::kHalfsphere;
  return HandMotion::kXyz;
}

Rig rig_of(const SynthRequest& request) {
  Rig rig;
  rig.camera = camera_of(request);
  rig.depth_units_per_m = request.depth.units_per_m;
  rig.has_imu = request.layout == SequenceLayout::kOpenLoris;
  rig.T_b_c = realsense_T_b_c();
  rig.imu_noise = request.imu.noise;
  return rig;
}

double last_path_time(const SynthRequest& request) { return kFirstFrame_s + request.seconds + kTail_s; }

Scene scene_of(const SynthRequest& request) {
  if (request.preset.starts_with("market")) return build_market(request.seed);
  if (request.preset.starts_with("corridor")) return build_corridor(request.seed);
  return build_office(request.seed);
}

Stage simulated_stage(const SynthRequest& request) {
  const Rig rig = rig_of(request);
  Scene scene = scene_of(request);
  const double last_s = last_path_time(request);
  const bool by_hand = request.preset.starts_with("walking");
  PathSpline path = by_hand ? hand_path(hand_motion_of(request.preset), scene.viewpoint, rig.T_b_c,
                                        request.seed, 0.0, last_s)
                            : robot_path(scene.route, rig.T_b_c, request.seed, 0.0, last_s);
  const Timestamp epoch{kEpoch_ns};
  InertialRecord inertia =
      measure_inertia(path, request.imu, epoch, 0.0, last_path_time(request), request.seed);
  const auto camera_at = [&](double t_s) {
    return Eigen::Vector2d((path.pose_at(t_s) * rig.T_b_c).p.head<2>());
  };
  std::vector<Actor> actors = cast_actors(request, scene, camera_at, 0.0, last_s);
  return {std::move(scene),   std::move(path),  rig, epoch, kFirstFrame_s,
          std::move(inertia), std::move(actors)};
}

std::vector<Eigen::Vector3d> camera_positions(const PathSpline& path, const Pose& T_b_c) {
  constexpr double kInterval_s = 0.05;
  std::vector<Eigen::Vector3d> positions;
  for (double t_s = path.first_s(); t_s < path.last_s(); t_s += kInterval_s) {
    positions.push_back((path.pose_at(t_s) * T_b_c).p);
  }
  return positions;
}

Stage flight_stage(const SynthRequest& request) {
  Flight flight = load_flight(request);
  Rig rig = rig_of(request);
  rig.T_b_c = flight.T_b_c;
  rig.imu_noise = ImuNoise{};  // a real sensor on a vibrating body: the wide densities of core/types
  const Eigen::Vector3d shift = hall_shift(camera_positions(flight.smoothed.path, rig.T_b_c));
  PathSpline path = flight.smoothed.path.shifted(shift);
  Scene scene = build_hall(request.seed, camera_positions(path, rig.T_b_c));
  return {std::move(scene), std::move(path), rig, flight.epoch, 0.0, std::move(flight.readings), {}};
}

}  // namespace

Stage make_stage(const SynthRequest& request) {
  return request.preset == "flight" ? flight_stage(request) : simulated_stage(request);
}

std::vector<Timestamp> frame_times(const SynthRequest& request, const Stage& stage) {
  RandomSequence random(random_key(request.seed, RandomStream::kDroppedFrames));
  // Runs have (1 + kLongestDrop) / 2 frames on average.
  const double start_chance =
      request.dropped_share / (0.5 * (1 + kLongestDrop)) / (1.0 - request.dropped_share);
  const int count = static_cast<int>(std::floor(request.seconds * request.frames_per_s));
  std::vector<Timestamp> times;
  int to_drop = 0;
  for (int i = 0; i < count; ++i) {
    if (to_drop == 0 && i > 0 && random.chance(start_chance)) to_drop = 1 + random.index(kLongestDrop);
    if (to_drop > 0) {
      --to_drop;
      continue;
    }
    const double since_epoch_s = stage.first_frame_s + i / request.frames_per_s;
    times.push_back({stage.epoch.ns / 1000 * 1000 + std::llround(since_epoch_s * 1e6) * 1000});
  }
  return times;
}

Shot shot_at(const SynthRequest& request, const Stage& stage, Timestamp t, double span_s) {
  const double middle_s = seconds_between(stage.epoch, t);
  const int rows = request.rolling_shutter_s > 0.0 ? request.height : 1;
  Shot shot;
  shot.span_s = static_cast<float>(span_s);
  shot.exposure_share_of_span = static_cast<float>(request.color.exposure_s / span_s);
  for (int row = 0; row < rows; ++row) {
    const double delay_s = rows > 1 ? request.rolling_shutter_s * (row / (rows - 1.0) - 0.5) : 0.0;
    std::array<Pose, kLightSamples> poses;
    for (int sample = 0; sample < kLightSamples; ++sample) {
      const double t_s = middle_s + delay_s + exposure_share(sample) * request.color.exposure_s;
      poses[static_cast<std::size_t>(sample)] = stage.body_path.pose_at(t_s) * stage.rig.T_b_c;
    }
    shot.poses.push_back(poses);
    shot.mid_times.push_back(static_cast<float>(0.5 + delay_s / span_s));
  }
  return shot;
}

Trajectory camera_truth(const SynthRequest& request, const Stage& stage) {
  Trajectory truth{"camera", {}};
  const double last_s = stage.first_frame_s + request.seconds + kTail_s;
  for (int i = 0;; ++i) {
    const double t_s = stage.first_frame_s - kFirstFrame_s + i * kTruthInterval_s;
    if (t_s > last_s) return truth;
    truth.poses.push_back({after(stage.epoch, t_s), stage.body_path.pose_at(t_s) * stage.rig.T_b_c});
  }
}

}  // namespace stillpoint
