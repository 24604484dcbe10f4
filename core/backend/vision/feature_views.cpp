// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/vision/feature_views.h"

#include <algorithm>
#include <utility>

#include "core/backend/vision/vision_assessment.h"
#include "core/config/monitor_config.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

/// A landmark has been triangulated when it was seen in as many frames.
constexpr std::size_t kMinObservations = 4;

/// Depth in the newest frame, whose camera pose is T_c_w^-1; see FeatureView.
double depth_of(const Landmark& landmark, const Window& window, const Pose& T_c_w) {
  const double measured = landmark.observations.back().depth;
  if (measured > 0.0 || landmark.inverse_depth <= 0.0 || landmark.observations.size() < kMinObservations)
    return measured;
  return std::max(0.0, (T_c_w * window.position(landmark)).z());
}

FeatureView view_of(const Window& window, Timestamp t, FeatureView view) {
  const WindowFrame& newest = window.frames.back();
  const NavState& before = window.frames[window.frames.size() - 2].state;
  view.t = t;
  view.stamp = newest.state.t;
  view.T_w_b = newest.state.T_w_b;
  view.velocity_w = before.T_w_b.q * newest.from_previous->delta_v(before.gyro_bias, before.accel_bias);
  view.rotation_b = log_so3(newest.from_previous->delta_q(before.gyro_bias));
  view.points.clear();
  const Pose T_c_w = window.T_w_c(window.newest()).inverse();
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.last() != window.newest()) continue;
    view.points.push_back({landmark.id, landmark.observations.back().bearing,
                           depth_of(landmark, window, T_c_w), !landmark.dynamic});
  }
  return view;
}

}  // namespace

bool FeatureViews::add(const Window& window) {
  const WindowFrame& newest = window.frames.back();
  const Timestamp t = after(newest.state.t, newest.time_offset_s);
  if (!views_.empty()) {
    const double interval_s = seconds_between(views_.back().t, t);
    if (interval_s > options_.history_s) views_.clear();
    if (interval_s < options_.min_interval_s) return false;
  }
  FeatureView recycled;
  if (!views_.empty() && seconds_between(views_.front().t, t) > options_.history_s) {
    recycled = std::move(views_.front());
    views_.erase(views_.begin());
  }
  views_.push_back(view_of(window, t, std::move(recycled)));
  return true;
}

std::optional<std::size_t> FeatureViews::before(Timestamp t, double seconds) const {
  for (std::size_t i = views_.size(); i-- > 0;) {
    if (seconds_between(views_[i].t, t) >= seconds) return i;
  }
  return std::nullopt;
}

std::optional<VisualPose> FeatureViews::pose_after(const VisualPose& before, std::size_t from, std::size_t to,
                                                   const Pose& T_b_c) {
  observations_.clear();
  auto later = views_[to].points.begin();
  for (const FeatureView::Point& point : views_[from].points) {
    while (later != views_[to].points.end() && later->id < point.id) ++later;
    if (later == views_[to].points.end()) break;
    if (later->id != point.id || point.depth <= 0.0 || !point.is_static) continue;
    if (!later->is_static && !options_.uses_relabeled) continue;
    observations_.push_back({point.depth * point.bearing.homogeneous(), later->bearing});
  }
  const Pose predicted = T_b_c.inverse() * (views_[from].T_w_b.inverse() * views_[to].T_w_b) * T_b_c;
  const double inlier = kMonitor.vision.pose_inlier_px / options_.focal_px;
  const Pose found = refine_camera_pose(observations_, predicted, inlier);
  const VisionAssessment vision = assess_vision(observations_, found, inlier / kMonitor.vision.inlier_sigmas);
  if (vision.has_few_features() || vision.has_weak_geometry() || vision.inliers < options_.min_agreeing ||
      vision.inliers < kMonitor.vision.min_agreeing_ratio * vision.features ||
      vision.inliers < options_.min_static_ratio * static_cast<double>(views_[to].points.size())) {
    return std::nullopt;
  }
  const UncertainPose T_bc = in_frame({found, vision.covariance}, T_b_c.inverse());
  Matrix6 turn = Matrix6::Identity();
  turn.topLeftCorner<3, 3>() = T_b_c.R();
  return VisualPose{.t = views_[to].t,
                    .T_w_b = before.T_w_b * (T_b_c * found * T_b_c.inverse()),
                    .covariance = propagate(turn, T_bc.covariance),
                    .features = vision.inliers};
}

}  // namespace stillpoint
