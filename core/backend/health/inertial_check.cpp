// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/inertial_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/imu/preintegration.h"

namespace stillpoint {
namespace {

constexpr double kMinInterval_s = 0.05;
constexpr double kHistory_s = 0.2;
constexpr double kMaxAccelError = 3.0;  // [m/s^2]
constexpr double kMaxGyroError = 0.1;   // [rad/s]
constexpr double kSigmas = 4.0;
constexpr int kAgreeingFrames = 6;
constexpr double kSettling_s = 0.5;

}  // namespace

std::optional<std::size_t> InertialCheck::pose_before(Timestamp t) const {
  for (std::size_t i = poses_.size(); i-- > 0;) {
    if (seconds_between(poses_[i].t, t) >= kMinInterval_s) return i;
  }
  return std::nullopt;
}

/// Largest ratio of an error to its limit.
std::optional<double> InertialCheck::severity(const VisualPose& pose, const NavState& state,
                                              const Eigen::Vector3d& gravity_w, ImuBuffer& imu) {
  const std::optional<std::size_t> middle = pose_before(pose.t);
  if (!middle) return std::nullopt;
  const VisualPose& B = poses_[*middle];
  const std::optional<std::size_t> first = pose_before(B.t);
  if (!first) return std::nullopt;
  const VisualPose& A = poses_[*first];
  Preintegration ab({}, state.gyro_bias, state.accel_bias, std::move(first_samples_));
  Preintegration bc({}, state.gyro_bias, state.accel_bias, std::move(second_samples_));
  ab.integrate(imu.samples_up_to(A.t, B.t));
  bc.integrate(imu.samples_up_to(B.t, pose.t));
  const double T1 = ab.duration_s(), T2 = bc.duration_s();
  const Eigen::Vector3d dp1 = ab.delta_p(state.gyro_bias, state.accel_bias);
  const Eigen::Vector3d dv1 = ab.delta_v(state.gyro_bias, state.accel_bias);
  const Eigen::Vector3d dp2 = bc.delta_p(state.gyro_bias, state.accel_bias);
  const Eigen::Vector3d v_1 =
      (B.T_w_b.p - A.T_w_b.p) / T1 + 0.5 * T1 * gravity_w + A.T_w_b.q * Eigen::Vector3d(dv1 - dp1 / T1);
  const Eigen::Vector3d v_2 =
      (pose.T_w_b.p - B.T_w_b.p) / T2 - 0.5 * T2 * gravity_w - B.T_w_b.q * Eigen::Vector3d(dp2 / T2);
  const double T = T1 + T2;
  const Eigen::Quaterniond q_C = A.T_w_b.q * ab.delta_q(state.gyro_bias) * bc.delta_q(state.gyro_bias);
  const double sigma_m = std::max({A.sigma_m, B.sigma_m, pose.sigma_m});
  const double sigma_rad = std::max(A.sigma_rad, pose.sigma_rad);
  const double accel_sigma = 2.0 * sigma_m * std::sqrt(2.0 / (T1 * T1) + 2.0 / (T2 * T2)) / T;
  const double gyro_sigma = sigma_rad * std::sqrt(2.0) / T;
  first_samples_ = ab.release_samples();
  second_samples_ = bc.release_samples();
  if (T1 <= 0.0 || T2 <= 0.0) return std::nullopt;
  return std::max((v_1 - v_2).norm() * 2.0 / T / (kMaxAccelError + kSigmas * accel_sigma),
                  q_C.angularDistance(pose.T_w_b.q) / T / (kMaxGyroError + kSigmas * gyro_sigma));
}

bool InertialCheck::update(const VisualPose& pose, const NavState& state, const Eigen::Vector3d& gravity_w,
                           ImuBuffer& imu) {
  if (resume_at_ && pose.t < *resume_at_) return consistent_;
  const std::optional<double> ratio = severity(pose, state, gravity_w, imu);
  std::erase_if(poses_, [&](const VisualPose& old) { return seconds_between(old.t, pose.t) > kHistory_s; });
  poses_.push_back(pose);
  if (!ratio) return consistent_;
  agreeing_frames_ = *ratio < 0.5 ? agreeing_frames_ + 1 : 0;
  if (!(*ratio <= 1.0)) consistent_ = false;
  if (agreeing_frames_ >= kAgreeingFrames) consistent_ = true;
  return consistent_;
}

void InertialCheck::interrupt(Timestamp t) {
  poses_.clear();
  resume_at_ = after(t, kSettling_s);
}

void InertialCheck::reset() {
  resume_at_.reset();
  poses_.clear();
  consistent_ = true;
  agreeing_frames_ = 0;
}

}  // namespace stillpoint
