// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/robot_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/geometry/so3.h"
#include "datasets/synthetic/closed_route.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/hand_motion.h"

namespace stillpoint {
namespace {

constexpr double kStep_s = 0.01;       // of the drive's integration
constexpr double kSmoothing_s = 0.15;  // knots of the drive: a wheeled robot turns gently
constexpr double kVibration_s = 0.01;  // knots of the whole
constexpr double kLookAhead_m = 0.6;   // turns are seen coming
constexpr double kVibration_m = 0.0004;
constexpr double kVibration_rad = 0.1 * std::numbers::pi / 180.0;

/// Mean over the near way of the speed that its bends allow.
double speed_at(const ClosedRoute& way, const RobotRoute& route, double distance_m) {
  constexpr int kSamples = 13;
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double near = distance_m + kLookAhead_m * (2.0 * i / (kSamples - 1) - 1.0);
    sum += std::min(route.speed, route.turn_rate / std::max(way.at(near).bend, 1e-6));
  }
  return sum / kSamples;
}

/// Distance driven at each multiple of kStep_s.
std::vector<double> drive(const ClosedRoute& way, const RobotRoute& route, double start_m,
                          double duration_s) {
  std::vector<double> distances{start_m};
  for (int i = 0; i * kStep_s < duration_s; ++i) {
    distances.push_back(distances.back() + kStep_s * speed_at(way, route, distances.back()));
  }
  return distances;
}

/// Shaking of the camera against the smooth drive.
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

}  // namespace

PathSpline robot_path(const RobotRoute& route, const Pose& T_b_c, std::uint64_t seed, double from_s,
                      double to_s) {
  RandomSequence random(random_key(seed, RandomStream::kMotion, 100));
  const ClosedRoute way(route.corners, route.turn_radius_m);
  const double lead_s = 6.0 * kSmoothing_s;  // the splines reach a little beyond their ends
  const std::vector<double> distances =
      drive(way, route, random.uniform(0.0, 2.0), to_s - from_s + 2.0 * lead_s);
  const Vibration vibration(random);
  const auto level_camera = [&](double t_s) {
    const double step =
        std::clamp((t_s - from_s + lead_s) / kStep_s, 0.0, static_cast<double>(distances.size()) - 1.0);
    const ClosedRoute::Place place = way.at(distances[static_cast<std::size_t>(std::lround(step))]);
    return Pose{camera_attitude(place.heading, 0.0, 0.0),
                {place.position.x(), place.position.y(), route.camera_height_m}};
  };
  const PathSpline smooth = spline_of(level_camera, from_s - 0.1, to_s + 0.1, kSmoothing_s);
  return spline_of([&](double t_s) { return smooth.pose_at(t_s) * vibration.at(t_s) * T_b_c.inverse(); },
                   from_s, to_s, kVibration_s);
}

}  // namespace stillpoint
