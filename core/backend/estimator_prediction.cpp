// SPDX-License-Identifier: BSD-3-Clause
// The estimator's newest frame at the pose that inertial data predicts.
#include "core/backend/estimator.h"
#include "core/backend/health/innovation.h"

namespace stillpoint {
namespace {

/// Normalized innovation of the features of a frame. On four rendered sequences the largest one is 4.6; that
/// of a clock that jumped is 9 or more.
constexpr double kUnexpectedNis = 5.0;

}  // namespace

void Estimator::check_prediction() {
  if (!has_inertial_prediction() || !window_.frames.back().from_previous) return;
  if (!step_check_.is_wrong(window_, imu_)) return;
  inertial_check_.contradict();
  evidence_.imu_defect = StatusReason::kImuInconsistent;
  distrust_recent_samples();
}

std::optional<UncertainPose> Estimator::predicted_camera() const {
  if (!has_inertial_prediction() || window_.newest() < 1) return std::nullopt;
  const WindowFrame& newest = window_.frames.back();
  const WindowFrame& before = window_.frames[window_.frames.size() - 2];
  if (!newest.from_previous || before.state.t != newest_.t) return std::nullopt;
  if (!newest_covariance_ || !newest_covariance_->inertial) return std::nullopt;
  const UncertainPose motion =
      predicted_motion(newest_, *newest_covariance_, *newest.from_previous, window_.gravity_w);
  return in_frame(compose({.T_w_f = before.state.T_w_b}, motion), window_.T_b_c);
}

double Estimator::residual_sigma() const {
  return pixel_noise_.applied_to(backend_).pixel_sigma_px / rig_.camera.focal_px();
}

void Estimator::record_reprojection_nis() {
  const std::optional<UncertainPose> predicted = predicted_camera();
  if (!predicted) return;
  update_.nis.reprojection = reprojection_nis(window_, *predicted, residual_sigma(), distances_);
  if (update_.nis.reprojection > kUnexpectedNis) pixel_noise_.expect_errors();
}

/// @param T_w_c        by vision alone, from `known_points_`
/// @param inlier_scale of that pose [normalized image plane]
void Estimator::record_inertial_nis(const Pose& T_w_c, double inlier_scale) {
  const std::optional<UncertainPose> predicted = predicted_camera();
  if (!predicted) return;
  const std::optional<UncertainPose> visual =
      with_covariance(known_points_, T_w_c, residual_sigma(), inlier_scale);
  if (visual) update_.nis.inertial = inertial_nis(*predicted, *visual);
}

}  // namespace stillpoint
