// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/walk.h"

#include <algorithm>
#include <cmath>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint {
namespace {

constexpr double kStep_s = 0.01;
constexpr double kAcceleration = 1.2;   // [m/s^2]
constexpr double kRetreatShare = 0.75;  // of the yielding distance: nearer than this, step back
constexpr double kLookAhead_m = 0.4;

/// Smooth heading: the mean over the near way, so that people turn like people.
double heading_at(const ClosedRoute& route, double distance_m) {
  double sum = 0.0;
  for (int i = -2; i <= 2; ++i) sum += route.at(distance_m + 0.1 * i).heading;
  return sum / 5.0;
}

}  // namespace

Walk::Walk(const ClosedRoute& route, const WalkStyle& style,
           const std::function<Eigen::Vector2d(double t_s)>& camera_at, std::uint64_t random_key,
           double from_s, double to_s)
    : route_(route), full_speed_(style.speed), from_s_(from_s) {
  RandomSequence random(random_key);
  double distance = style.start_m, speed = style.speed, rest_until_s = from_s;
  for (double t_s = from_s; t_s < to_s + kStep_s; t_s += kStep_s) {
    steps_.push_back({distance, speed});
    if (random.chance(style.stops_per_minute / 60.0 * kStep_s)) {
      rest_until_s = t_s + style.stop_s * random.uniform(0.5, 1.5);
    }
    const Eigen::Vector2d camera = camera_at(t_s);
    const double ahead = (route_.at(distance + kLookAhead_m).position - camera).norm();
    const double here = (route_.at(distance).position - camera).norm();
    const double back = (route_.at(distance - kLookAhead_m).position - camera).norm();
    double wanted = t_s < rest_until_s ? 0.0 : style.speed;
    if (std::min(here, ahead) < style.yield_m && ahead < here) wanted = 0.0;
    if (here < kRetreatShare * style.yield_m) wanted = (back > ahead ? -1.0 : 1.0) * style.speed;
    speed += std::clamp(wanted - speed, -kAcceleration * kStep_s, kAcceleration * kStep_s);
    distance += speed * kStep_s;
  }
}

Walk::State Walk::at(double t_s) const {
  const double step = std::clamp((t_s - from_s_) / kStep_s, 0.0, static_cast<double>(steps_.size()) - 1.001);
  const auto index = static_cast<std::size_t>(step);
  const double share = step - std::floor(step);
  const double distance = std::lerp(steps_[index].distance_m, steps_[index + 1].distance_m, share);
  const double speed = std::lerp(steps_[index].speed, steps_[index + 1].speed, share);
  return {route_.at(distance).position, heading_at(route_, distance), distance,
          std::min(1.0, std::abs(speed) / full_speed_)};
}

}  // namespace stillpoint
