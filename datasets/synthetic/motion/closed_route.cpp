// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/motion/closed_route.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector2d;

constexpr double kStep_m = 0.02;
constexpr double kStartFraction = 0.15;  // of the first side
constexpr double kTurn = 2.0 * std::numbers::pi;

double angle_between(const Vector2d& a, const Vector2d& b) {
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

/// Points of the arc that rounds a corner.
std::vector<Vector2d> arc(const Vector2d& corner, const Vector2d& in, const Vector2d& out, double radius) {
  const double angle = angle_between(in, out);
  const double reach = radius * std::tan(0.5 * std::abs(angle));
  const Vector2d side = (angle > 0.0 ? 1.0 : -1.0) * Vector2d(-in.y(), in.x());
  const Vector2d start = corner - reach * in;
  const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(angle) * radius / kStep_m)));
  std::vector<Vector2d> points;
  for (int i = 0; i <= steps; ++i) {
    const double turned = std::abs(angle) * i / steps;
    points.push_back(start + radius * (std::sin(turned) * in + (1.0 - std::cos(turned)) * side));
  }
  return points;
}

void add_straight(std::vector<Vector2d>& points, const Vector2d& to) {
  const Vector2d from = points.back();
  const int steps = static_cast<int>((to - from).norm() / kStep_m);
  for (int i = 1; i < steps; ++i) points.push_back(from + (to - from) * (static_cast<double>(i) / steps));
}

std::vector<Vector2d> rounded(const std::vector<Vector2d>& corners, double radius_m) {
  const std::size_t count = corners.size();
  const auto corner = [&](std::size_t i) { return corners[i % count]; };
  const auto side = [&](std::size_t i) { return Vector2d(corner(i + 1) - corner(i)); };
  std::vector<Vector2d> points{corner(0) + kStartFraction * side(0)};
  for (std::size_t i = 1; i <= count; ++i) {
    const Vector2d in = side(i - 1).normalized(), out = side(i).normalized();
    const double shorter = std::min(side(i - 1).norm(), side(i).norm());
    const double half_angle_tan = std::tan(0.5 * std::abs(angle_between(in, out)));
    // At most half of a side; at the first corner at most the distance from the corner to the start.
    const double reach = (i == count ? 0.9 * kStartFraction : 0.499) * shorter;
    const std::vector<Vector2d> turn =
        arc(corner(i), in, out, std::min(radius_m, reach / std::max(half_angle_tan, 1e-9)));
    add_straight(points, turn.front());
    points.insert(points.end(), turn.begin(), turn.end());
  }
  add_straight(points, points.front());
  points.push_back(points.front());
  return points;
}

}  // namespace

ClosedRoute::ClosedRoute(const std::vector<Vector2d>& corners, double radius_m) {
  STILLPOINT_CHECK(corners.size() >= 3);
  for (const Vector2d& point : rounded(corners, radius_m)) {
    const double step = points_.empty() ? 0.0 : (point - points_.back()).norm();
    if (!points_.empty() && step < 1e-6) continue;
    distances_.push_back(points_.empty() ? 0.0 : distances_.back() + step);
    points_.push_back(point);
  }
  double heading = 0.0;
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    const Vector2d step = points_[i + 1] - points_[i];
    heading += std::remainder(std::atan2(step.y(), step.x()) - heading, kTurn);
    headings_.push_back(heading);
  }
  headings_.push_back(heading + std::remainder(headings_.front() - heading, kTurn));
}

ClosedRoute::RoutePoint ClosedRoute::at(double distance_m) const {
  const double lap = std::floor(distance_m / length_m());
  const double along = distance_m - lap * length_m();
  const auto next = std::upper_bound(distances_.begin() + 1, distances_.end() - 1, along);
  const auto i = static_cast<std::size_t>(next - distances_.begin()) - 1;
  const double step = distances_[i + 1] - distances_[i];
  const double fraction = (along - distances_[i]) / step;
  const double turn = headings_[i + 1] - headings_[i];
  return {points_[i] + fraction * (points_[i + 1] - points_[i]),
          headings_[i] + fraction * turn + lap * (headings_.back() - headings_.front()),
          std::abs(turn) / step};
}

}  // namespace stillpoint::synth
