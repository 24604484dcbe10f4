// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/robot_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/geometry/so3.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/hand_motion.h"

namespace stillpoint {
namespace {

using Eigen::Vector2d;

constexpr double kStep_m = 0.02;       // between points of the route
constexpr double kSmoothing_s = 0.15;  // knots of the drive: a wheeled robot turns gently
constexpr double kVibration_s = 0.01;  // knots of the whole
constexpr int kSpeedWindow = 30;       // points over which the speed is averaged
constexpr double kVibration_m = 0.0004;
constexpr double kVibration_rad = 0.1 * std::numbers::pi / 180.0;

/// A point of the route as it is driven.
struct RoutePoint {
  Vector2d place;
  double heading;  // [rad], continuous
  double time_s;
};

/// Rounds one corner: points of the arc between the two straights.
void add_arc(std::vector<Vector2d>& points, const Vector2d& corner, const Vector2d& in, const Vector2d& out,
             double radius) {
  const double angle = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
  const double reach = radius * std::tan(0.5 * std::abs(angle));
  const Vector2d side = (angle > 0.0 ? 1.0 : -1.0) * Vector2d(-in.y(), in.x());
  const Vector2d start = corner - reach * in;
  const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(angle) * radius / kStep_m)));
  for (int i = 0; i <= steps; ++i) {
    const double turned = std::abs(angle) * i / steps;
    points.push_back(start + radius * (std::sin(turned) * in + (1.0 - std::cos(turned)) * side));
  }
}

void add_straight(std::vector<Vector2d>& points, const Vector2d& to) {
  const Vector2d from = points.back();
  const int steps = static_cast<int>((to - from).norm() / kStep_m);
  for (int i = 1; i < steps; ++i) points.push_back(from + (to - from) * (static_cast<double>(i) / steps));
}

/// The closed polygon with rounded corners.
std::vector<Vector2d> rounded(const RobotRoute& route) {
  const std::size_t count = route.corners.size();
  const auto corner = [&](std::size_t i) { return route.corners[i % count]; };
  const auto direction = [&](std::size_t i) { return Vector2d((corner(i + 1) - corner(i)).normalized()); };
  std::vector<Vector2d> points{corner(0) +
                               0.15 * (corner(1) - corner(0))};  // starts early on the first straight
  for (std::size_t i = 1; i <= count; ++i) {
    const Vector2d in = direction(i - 1), out = direction(i);
    const double shorter = std::min((corner(i) - corner(i - 1)).norm(), (corner(i + 1) - corner(i)).norm());
    const double half_angle = 0.5 * std::acos(std::clamp(in.dot(out), -1.0, 1.0));
    const double radius = std::min(route.turn_radius_m, 0.499 * shorter / std::tan(half_angle));
    std::vector<Vector2d> arc;
    add_arc(arc, corner(i), in, out, radius);
    add_straight(points, arc.front());
    points.insert(points.end(), arc.begin(), arc.end());
  }
  add_straight(points, points.front());
  return points;
}

/// Speed at each point: slower in turns, averaged so that it changes gently.
std::vector<double> speeds(const std::vector<Vector2d>& places, const RobotRoute& route) {
  const int count = static_cast<int>(places.size());
  const auto place = [&](int i) { return places[static_cast<std::size_t>((i + count) % count)]; };
  std::vector<double> allowed, averaged;
  for (int i = 0; i < count; ++i) {
    const Vector2d before = place(i) - place(i - 1), behind = place(i + 1) - place(i);
    const double turn = std::atan2(before.x() * behind.y() - before.y() * behind.x(), before.dot(behind));
    const double bend = std::abs(turn) / std::max(behind.norm(), 1e-6);  // [rad/m]
    allowed.push_back(std::min(route.speed, route.turn_rate / std::max(bend, 1e-6)));
  }
  for (int i = 0; i < count; ++i) {
    double sum = 0.0;
    for (int k = -kSpeedWindow; k <= kSpeedWindow; ++k) {
      sum += allowed[static_cast<std::size_t>((i + k + count) % count)];
    }
    averaged.push_back(sum / (2 * kSpeedWindow + 1));
  }
  return averaged;
}

/// The route lap after lap, until `duration_s` have passed. @param skipped_m of the first lap
std::vector<RoutePoint> drive(const RobotRoute& route, double skipped_m, double duration_s) {
  const std::vector<Vector2d> places = rounded(route);
  const std::vector<double> speed = speeds(places, route);
  std::vector<RoutePoint> points;
  double heading = 0.0, time_s = 0.0;
  for (std::size_t i = static_cast<std::size_t>(skipped_m / kStep_m); time_s <= duration_s; ++i) {
    const Vector2d here = places[i % places.size()];
    const Vector2d step = places[(i + 1) % places.size()] - here;
    heading += std::remainder(std::atan2(step.y(), step.x()) - heading, 2.0 * std::numbers::pi);
    points.push_back({here, heading, time_s});
    time_s += step.norm() / speed[i % places.size()];
  }
  return points;
}

/// Level camera on the robot at `t_s` of the drive.
Pose camera_on(const std::vector<RoutePoint>& points, double height_m, double t_s) {
  const auto next = std::find_if(points.begin() + 1, points.end() - 1,
                                 [t_s](const RoutePoint& point) { return point.time_s >= t_s; });
  const RoutePoint& a = *(next - 1);
  const double share = std::clamp((t_s - a.time_s) / (next->time_s - a.time_s), 0.0, 1.0);
  const Vector2d place = a.place + share * (next->place - a.place);
  return {camera_attitude(std::lerp(a.heading, next->heading, share), 0.0, 0.0),
          {place.x(), place.y(), height_m}};
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
  STILLPOINT_CHECK(route.corners.size() >= 3);
  RandomSequence random(random_key(seed, RandomStream::kMotion, 100));
  const double lead_s = 6.0 * kSmoothing_s;  // the splines reach a little beyond their ends
  const std::vector<RoutePoint> points = drive(route, random.uniform(0.0, 2.0), to_s - from_s + 2.0 * lead_s);
  const Vibration vibration(random);
  const PathSpline smooth =
      spline_of([&](double t_s) { return camera_on(points, route.camera_height_m, t_s - from_s + lead_s); },
                from_s - 0.1, to_s + 0.1, kSmoothing_s);
  return spline_of([&](double t_s) { return smooth.pose_at(t_s) * vibration.at(t_s) * T_b_c.inverse(); },
                   from_s, to_s, kVibration_s);
}

}  // namespace stillpoint
