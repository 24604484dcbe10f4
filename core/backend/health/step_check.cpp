// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/step_check.h"

namespace stillpoint {
namespace {

constexpr double kMinViewInterval_s = 0.05;
constexpr double kMinAccelChange = 1.5;  // [m/s^2]
constexpr double kMinGyroChange = 0.05;  // [rad/s]

constexpr double kMaxStepAccelError = 1.5;  // [m/s^2]
constexpr double kMaxStepGyroError = 0.05;  // [rad/s]

constexpr double kStepSigmas = 2.0;

/// Between the three views at these indices.
struct Views {
  std::size_t first;
  std::size_t middle;
  std::size_t last;
};

/// The newest view and earlier ones with the given intervals.
std::optional<Views> spaced(const FeatureViews& views, double interval_s) {
  const std::size_t last = views.size() - 1;
  const std::optional<std::size_t> middle = views.before(views[last].t, interval_s);
  if (!middle) return std::nullopt;
  const std::optional<std::size_t> first = views.before(views[*middle].t, interval_s);
  if (!first) return std::nullopt;
  return Views{*first, *middle, last};
}

std::optional<InertialError> error_between(const Views& chosen, FeatureViews& views, const Window& window,
                                           ImuBuffer& imu) {
  const VisualPose A{.t = views[chosen.first].t, .T_w_b = views[chosen.first].T_w_b};
  const std::optional<VisualPose> B = views.pose_after(A, chosen.first, chosen.middle, window.T_b_c);
  if (!B) return std::nullopt;
  const std::optional<VisualPose> C = views.pose_after(*B, chosen.middle, chosen.last, window.T_b_c);
  if (!C) return std::nullopt;
  return inertial_error({.A = A, .B = *B, .C = *C}, window.frames.back().state, window.gravity_w, imu);
}

}  // namespace

/// Whether the mean specific force or angular rate differs between (first, middle] and (middle, newest].
bool StepCheck::data_changed(std::size_t first, std::size_t middle) const {
  Eigen::Vector3d accel[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  Eigen::Vector3d gyro[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (std::size_t i = first + 1; i < views_.size(); ++i) {
    accel[i > middle] += views_[i].velocity_w;
    gyro[i > middle] += views_[i].rotation_b;
  }
  const double T1 = seconds_between(views_[first].t, views_[middle].t);
  const double T2 = seconds_between(views_[middle].t, views_[views_.size() - 1].t);
  return (accel[1] / T2 - accel[0] / T1).norm() > kMinAccelChange ||
         (gyro[1] / T2 - gyro[0] / T1).norm() > kMinGyroChange;
}

bool StepCheck::is_wrong(const Window& window, ImuBuffer& imu) {
  static_cast<void>(views_.add(window));
  const std::optional<Views> chosen = spaced(views_, kMinViewInterval_s);
  if (!chosen || !data_changed(chosen->first, chosen->middle)) return false;
  const std::optional<InertialError> error = error_between(*chosen, views_, window, imu);
  if (!error) return false;
  const bool accel = error->accel_w.norm() > kMaxStepAccelError + kStepSigmas * error->accel_sigma;
  const bool gyro = error->gyro_b.norm() > kMaxStepGyroError + kStepSigmas * error->gyro_sigma;
  return (accel && error->accel_is_explained()) || (gyro && error->gyro_is_explained());
}

}  // namespace stillpoint
