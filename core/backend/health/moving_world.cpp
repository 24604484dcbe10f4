// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/moving_world.h"

#include <algorithm>
#include <cmath>

#include "core/config/monitor_config.h"

namespace stillpoint {
namespace {

constexpr double kInterval_s = 0.2;
constexpr double kMinDuration_s = 1.5;
constexpr std::size_t kMinPoints = 15;
constexpr double kMinCommonRatio = 0.4;
constexpr double kMaxWindowRatio = 0.15;
constexpr double kAgreeingWindowRatio = 0.3;
/// A person whose points are most of all is close to the camera: at most 0.3 m in renderings. Market and a
/// corridor: 2.4 m, a small room: 0.5 to 1.3 m.
constexpr double kMinExtent_m = 0.6;

/// Index of the newest frame at least `kInterval_s` before the newest one; -1: none.
int earlier_frame(const Window& window) {
  const Timestamp newest = window.frames.back().state.t;
  for (int i = window.newest() - 1; i >= 0; --i) {
    if (seconds_between(window.frames[static_cast<std::size_t>(i)].state.t, newest) >= kInterval_s) return i;
  }
  return -1;
}

}  // namespace

MovingWorld::MovingWorld(double focal_px) : inlier_(kMonitor.vision.pose_inlier_px / focal_px) {}

bool MovingWorld::update(const Window& window) {
  const std::optional<bool> moves = appears_to_move(window);
  if (!moves) return false;
  if (!*moves) {
    since_.reset();
    return false;
  }
  const Timestamp t = window.frames.back().state.t;
  if (!since_) since_ = t;
  return seconds_between(*since_, t) >= kMinDuration_s;
}

std::optional<bool> MovingWorld::appears_to_move(const Window& window) {
  const int earlier = earlier_frame(window);
  if (earlier < 0) return std::nullopt;
  points_.clear();
  std::size_t dynamic = 0;
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.last() != window.newest() || !landmark.observed_in(earlier)) continue;
    const Observation& before = landmark.observation_in(earlier);
    if (before.depth <= 0.0) continue;
    points_.push_back({before.depth / window.depth_scale * before.bearing.homogeneous(),
                       landmark.observations.back().bearing});
    dynamic += landmark.dynamic ? 1 : 0;
  }
  if (2 * dynamic <= points_.size()) return false;
  if (points_.size() < kMinPoints) return std::nullopt;
  const auto count = static_cast<double>(points_.size());
  const Pose T_before_now = window.T_w_c(earlier).inverse() * window.T_w_c(window.newest());
  const std::size_t of_window = count_inliers(T_before_now.inverse(), points_, inlier_);
  if (static_cast<double>(of_window) >= kAgreeingWindowRatio * count) return false;
  if (static_cast<double>(of_window) >= kMaxWindowRatio * count) return std::nullopt;
  const std::optional<CameraPose> common =
      estimate_camera_pose(points_, T_before_now, {.inlier_threshold = inlier_});
  if (!common || common->inliers < kMinCommonRatio * count) return std::nullopt;
  if (extent(common->T_w_c) < kMinExtent_m) return std::nullopt;
  return true;
}

double MovingWorld::extent(const Pose& T_w_c) {
  const Pose T_c_w = T_w_c.inverse();
  double largest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    coordinates_.clear();
    for (const PointObservation& point : points_) {
      if (count_inliers(T_c_w, {&point, 1}, inlier_) == 1) coordinates_.push_back(point.p_w[axis]);
    }
    std::ranges::sort(coordinates_);
    const std::size_t quarter = coordinates_.size() / 4;
    largest = std::max(largest, coordinates_[coordinates_.size() - 1 - quarter] - coordinates_[quarter]);
  }
  return largest;
}

}  // namespace stillpoint
