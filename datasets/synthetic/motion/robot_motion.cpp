// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/motion/robot_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "core/base/error.h"
#include "core/geometry/so3.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/motion/closed_route.h"
#include "datasets/synthetic/motion/hand_motion.h"

namespace stillpoint::synth {
namespace {

constexpr double kStep_s = 0.01;       // integration step of the driven distance
constexpr double kSmoothing_s = 0.15;  // knot interval of the path without vibration
constexpr double kVibration_s = 0.01;  // knot interval of the final path
constexpr double kLookAhead_m = 0.6;   // the robot slows down before turns
constexpr double kVibration_m = 0.0004;
constexpr double kVibration_rad = 0.1 * std::numbers::pi / 180.0;
constexpr double kTrackStep_s = 0.05;  // of the resampled track
constexpr double kKernelReach = 3.0;   // of the Gaussian, in standard deviations

/// Speed allowed by the route's curvature, averaged over +-kLookAhead_m.
double speed_at(const ClosedRoute& closed_route, const RobotRoute& route, double distance_m) {
  constexpr int kSamples = 13;
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double distance = distance_m + kLookAhead_m * (2.0 * i / (kSamples - 1) - 1.0);
    sum += std::min(route.speed, route.turn_rate / std::max(closed_route.at(distance).curvature, 1e-6));
  }
  return sum / kSamples;
}

/// Distance driven at each multiple of kStep_s.
std::vector<double> drive(const ClosedRoute& closed_route, const RobotRoute& route, double start_m,
                          double duration_s) {
  std::vector<double> distances{start_m};
  for (int i = 0; i * kStep_s < duration_s; ++i) {
    distances.push_back(distances.back() + kStep_s * speed_at(closed_route, route, distances.back()));
  }
  return distances;
}

/// Vibration relative to the smooth path.
class Vibration {
 public:
  explicit Vibration(RandomSequence& random) {
    for (Wave& wave : waves_) {
      wave = {2.0 * std::numbers::pi * random.uniform(7.0, 17.0),
              random.uniform(0.0, 2.0 * std::numbers::pi)};
    }
  }
  [[nodiscard]] Pose at(double t_s) const {
    const auto wave = [&](std::size_t i) { return std::sin(waves_[i].rate * t_s + waves_[i].phase); };
    return {exp_so3(kVibration_rad * Eigen::Vector3d(wave(0), wave(1), wave(2))),
            kVibration_m * Eigen::Vector3d(wave(3), wave(4), wave(5))};
  }

 private:
  struct Wave {
    double rate, phase;
  };
  std::array<Wave, 6> waves_;
};

/// The path of the body for a camera without vibration: a function of time.
template <class LevelCamera>
PathSpline vibrating_path(const LevelCamera& level_camera, const Vibration& vibration,
                          const PathRequest& request) {
  const Pose& T_b_c = request.T_b_c;
  const double from_s = request.from_s, to_s = request.to_s;
  const PathSpline smooth = spline_of(level_camera, from_s - 0.1, to_s + 0.1, kSmoothing_s);
  return spline_of([&](double t_s) { return smooth.pose_at(t_s) * vibration.at(t_s) * T_b_c.inverse(); },
                   from_s, to_s, kVibration_s);
}

/// A track with uniform intervals, filtered by a Gaussian kernel.
class FilteredTrack {
 public:
  FilteredTrack(std::span<const PlanarPose> poses, double sigma_s)
      : start_s_(poses.front().t_s), sigma_s_(sigma_s) {
    std::size_t i = 0;
    for (int k = 0;; ++k) {
      const double t_s = start_s_ + k * kTrackStep_s;
      while (i + 2 < poses.size() && poses[i + 1].t_s <= t_s) ++i;
      const PlanarPose &low = poses[i], &high = poses[i + 1];
      const double fraction = std::clamp((t_s - low.t_s) / (high.t_s - low.t_s), 0.0, 1.0);
      samples_.push_back({t_s, low.position + fraction * (high.position - low.position),
                          std::lerp(low.heading, high.heading, fraction)});
      if (t_s > poses.back().t_s) return;
    }
  }
  [[nodiscard]] PlanarPose at(double t_s) const {
    const int last = static_cast<int>(samples_.size()) - 1;
    const int reach = static_cast<int>(kKernelReach * sigma_s_ / kTrackStep_s);
    const int middle = static_cast<int>(std::lround((t_s - start_s_) / kTrackStep_s));
    PlanarPose mean{t_s, Eigen::Vector2d::Zero(), 0.0};
    double sum = 0.0;
    for (int k = middle - reach; k <= middle + reach; ++k) {
      const PlanarPose& sample = samples_[static_cast<std::size_t>(std::clamp(k, 0, last))];
      const double distance = (start_s_ + k * kTrackStep_s - t_s) / sigma_s_;
      const double weight = std::exp(-0.5 * distance * distance);
      mean.position += weight * sample.position;
      mean.heading += weight * sample.heading;
      sum += weight;
    }
    return {t_s, mean.position / sum, mean.heading / sum};
  }

 private:
  std::vector<PlanarPose> samples_;
  double start_s_, sigma_s_;
};

}  // namespace

PathSpline robot_path(const RobotRoute& route, const PathRequest& request) {
  const double from_s = request.from_s, to_s = request.to_s;
  RandomSequence random(random_key(request.seed, RandomStream::kMotion, 100));
  const ClosedRoute closed_route(route.corners, route.turn_radius_m);
  const double lead_s = 6.0 * kSmoothing_s;  // margin for the control points beyond both ends
  const std::vector<double> distances =
      drive(closed_route, route, random.uniform(0.0, 2.0), to_s - from_s + 2.0 * lead_s);
  const Vibration vibration(random);
  const auto level_camera = [&](double t_s) {
    const double step =
        std::clamp((t_s - from_s + lead_s) / kStep_s, 0.0, static_cast<double>(distances.size()) - 1.0);
    const ClosedRoute::RoutePoint point =
        closed_route.at(distances[static_cast<std::size_t>(std::lround(step))]);
    return Pose{camera_attitude(point.heading, 0.0, 0.0),
                {point.position.x(), point.position.y(), route.camera_height_m}};
  };
  return vibrating_path(level_camera, vibration, request);
}

PathSpline robot_path(const RobotTrack& track, const PathRequest& request) {
  STILLPOINT_CHECK(track.poses.size() >= 2);
  RandomSequence random(random_key(request.seed, RandomStream::kMotion, 101));
  const Vibration vibration(random);
  const FilteredTrack filtered(track.poses, track.smoothing_s);
  const auto level_camera = [&](double t_s) {
    const PlanarPose base = filtered.at(t_s);
    const Eigen::Vector2d forward(std::cos(base.heading), std::sin(base.heading));
    const Eigen::Vector2d position = base.position + track.camera_forward_m * forward;
    return Pose{camera_attitude(base.heading, 0.0, 0.0), {position.x(), position.y(), track.camera_height_m}};
  };
  return vibrating_path(level_camera, vibration, request);
}

}  // namespace stillpoint::synth
