// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/actors/walk.h"

#include <algorithm>
#include <cmath>

#include "datasets/synthetic/counter_random.h"

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

}  // namespace stillpoint::synth
