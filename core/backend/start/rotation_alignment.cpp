// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/rotation_alignment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/geometry/covariance.h"
#include "core/geometry/so3.h"
#include "core/imu/propagation.h"
#include "core/types/rig_tolerance.h"

namespace stillpoint {
namespace {

constexpr double kMinSpan_s = 1.5;
constexpr double kMaxSpan_s = 3.0;
constexpr double kCertainRotation_rad = 0.005;
constexpr double kCertainOffset_s = 0.001;

constexpr int kIterations = 8;
constexpr double kRateHalfWidth_s = 0.02;  // the noise of one sample would bias the time offset
constexpr double kMinSigma_rad = 3e-4;     // of a rotation by vision over an interval, per axis
constexpr double kCauchyScale = 3.0;       // [standard deviations]
constexpr double kMedianNorm = 1.538;      // median length of a vector of three standard normal components

/// Rotation by the gyroscope, and the derivative of its vector by the bias.
struct GyroRotation {
  Eigen::Quaterniond dq = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d by_bias = Eigen::Matrix3d::Zero();
};

GyroRotation integrate_gyro(const std::vector<ImuSample>& samples, const Eigen::Vector3d& bias) {
  GyroRotation rotation;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const Eigen::Vector3d theta = midpoint_rotation(samples[i - 1], samples[i], bias);
    const Eigen::Quaterniond step = exp_so3(theta);
    rotation.dq = (rotation.dq * step).normalized();
    rotation.by_bias = step.conjugate() * rotation.by_bias -
                       right_jacobian(theta) * seconds_between(samples[i - 1].t, samples[i].t);
  }
  return rotation;
}

}  // namespace

RotationAligner::RotationAligner(const BackendConfig& config, const Rig& rig)
    : q_b_c_(rig.T_b_c.q), time_offset_s_(rig.time_offset_s) {
  const double offset_sigma_s = config.estimate_time_offset ? config.time_offset_sigma_s : 1e-9;
  prior_information_ << Eigen::Vector3d::Constant(config.extrinsics_sigma_rad), offset_sigma_s,
      Eigen::Vector3d::Constant(config.initializer.gyro_bias_sigma);
  prior_information_ = prior_information_.cwiseInverse().cwiseAbs2().eval();
}

std::vector<RotationAligner::Residual> RotationAligner::residuals(const RotationAlignment& at,
                                                                  ImuBuffer& imu) const {
  std::vector<Residual> found;
  for (const CameraRotation& rotation : rotations_) {
    const Timestamp begin = after(rotation.begin, at.time_offset_s);
    const Timestamp end = after(rotation.end, at.time_offset_s);
    const std::optional<ImuSample> w_i = imu.mean_around(begin, kRateHalfWidth_s);
    const std::optional<ImuSample> w_j = imu.mean_around(end, kRateHalfWidth_s);
    const std::vector<ImuSample>& samples = imu.samples_between(begin, end);
    if (samples.size() < 2 || !w_i || !w_j) continue;
    const GyroRotation gyro = integrate_gyro(samples, at.gyro_bias);
    Residual residual;
    residual.r = log_so3(gyro.dq.conjugate() * at.q_b_c * rotation.dq_c * at.q_b_c.conjugate());
    residual.J << at.q_b_c * (rotation.dq_c.toRotationMatrix().transpose() - Eigen::Matrix3d::Identity()),
        gyro.dq.conjugate() * (w_i->gyro_b - at.gyro_bias) - (w_j->gyro_b - at.gyro_bias), -gyro.by_bias;
    found.push_back(residual);
  }
  return found;
}

RotationAligner::NormalEquations RotationAligner::normal_equations(const RotationAlignment& at,
                                                                   ImuBuffer& imu) const {
  Unknowns from_rig;
  from_rig << log_so3(q_b_c_.conjugate() * at.q_b_c), at.time_offset_s - time_offset_s_, at.gyro_bias;
  NormalEquations equations{.H = prior_information_.asDiagonal(),
                            .g = -prior_information_.cwiseProduct(from_rig)};
  const std::vector<Residual> all = residuals(at, imu);
  if (all.empty()) return equations;
  std::vector<double> norms;
  norms.reserve(all.size());
  for (const Residual& residual : all) norms.push_back(residual.r.norm());
  const auto middle = norms.begin() + static_cast<std::ptrdiff_t>(norms.size() / 2);
  std::ranges::nth_element(norms, middle);
  const double variance = std::pow(std::max(kMinSigma_rad, *middle / kMedianNorm), 2);
  for (const auto& [r, J] : all) {
    const double weight = 1.0 / (variance + r.squaredNorm() / (kCauchyScale * kCauchyScale));
    equations.H += weight * J.transpose() * J;
    equations.g -= weight * J.transpose() * r;
  }
  return equations;
}

std::optional<RotationAlignment> RotationAligner::align(Timestamp now, ImuBuffer& imu) {
  if (!first_) first_ = now;
  const double span = seconds_between(*first_, now);
  if (span < kMinSpan_s) return std::nullopt;
  RotationAlignment found{.q_b_c = q_b_c_, .time_offset_s = time_offset_s_};
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const NormalEquations equations = normal_equations(found, imu);
    const Unknowns step = equations.H.ldlt().solve(equations.g);
    found.q_b_c = (found.q_b_c * exp_so3(step.head<3>())).normalized();
    found.time_offset_s += step[3];
    found.gyro_bias += step.tail<3>();
  }
  found.covariance = normal_equations(found, imu).H.inverse().topLeftCorner<4, 4>();
  Eigen::Vector4d from_rig;
  from_rig << log_so3(q_b_c_.conjugate() * found.q_b_c), found.time_offset_s - time_offset_s_;
  Eigen::Matrix4d tolerated = found.covariance;
  tolerated.diagonal().head<3>().array() += rig_tolerance::kRotation_rad * rig_tolerance::kRotation_rad;
  tolerated(3, 3) += rig_tolerance::kTimeOffset_s * rig_tolerance::kTimeOffset_s;
  found.rig_contradiction = from_rig.dot(tolerated.llt().solve(from_rig));
  const bool certain = largest_sigma(found.covariance.topLeftCorner<3, 3>()) < kCertainRotation_rad &&
                       found.covariance(3, 3) < kCertainOffset_s * kCertainOffset_s;
  if (!certain && span < kMaxSpan_s) return std::nullopt;
  found.is_certain = certain;
  return found;
}

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
