// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/camera_rotations.h"

#include <utility>

namespace stillpoint {
namespace {

constexpr double kInterval_s = 0.2;
constexpr double kLongestInterval_s = 0.35;
constexpr int kMinFeatures = 20;

}  // namespace

CameraRotations::CameraRotations(double focal_px)
    : views_({.focal_px = focal_px,
              .min_interval_s = kInterval_s,
              .history_s = kLongestInterval_s,
              .min_agreeing = kMinFeatures}) {}

std::optional<CameraRotation> CameraRotations::add(const Window& window) {
  const WindowFrame& newest = window.frames.back();
  if (!newest.from_previous || !views_.add(window)) return std::nullopt;
  const Timestamp before = std::exchange(last_, newest.state.t);
  const std::size_t to = views_.size() - 1;
  if (to == 0) return std::nullopt;
  const std::optional<VisualPose> moved = views_.pose_after({}, to - 1, to, window.T_b_c);
  if (!moved) return std::nullopt;
  const Eigen::Quaterniond& q_b_c = window.T_b_c.q;
  return CameraRotation{before, newest.state.t, (q_b_c.conjugate() * moved->T_w_b.q * q_b_c).normalized()};
}

}  // namespace stillpoint
