// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/rotation_alignment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/LU>

#include "core/geometry/covariance.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"
#include "core/imu/propagation.h"
#include "core/types/rig_tolerance.h"

namespace stillpoint {
namespace {

constexpr double kMinOffsetSpan_s = 0.5;  // before a depth scale is found with the wrong offset
constexpr double kMinSpan_s = 1.5;
constexpr double kMaxSpan_s = 3.0;
constexpr double kCertainRotation_rad = 0.005;
constexpr double kCertainOffset_s = 0.001;

constexpr double kOffsetStep_s = 0.005;  // a tenth of the period of 20 Hz, faster than vibrations of vehicles
constexpr double kDistinctResidual = 0.7;  // samples 50 ms late: 0.14 (market) to 0.69 (walking_xyz)

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

/// Attitude by the gyroscope alone, since the first one.
struct GyroAttitude {
  Timestamp t;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
};

std::vector<GyroAttitude> attitudes(const std::vector<ImuSample>& samples) {
  std::vector<GyroAttitude> all;
  all.reserve(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    GyroAttitude next{.t = samples[i].t};
    if (i > 0) {
      const Eigen::Vector3d theta = midpoint_rotation(samples[i - 1], samples[i], Eigen::Vector3d::Zero());
      next.q = (all.back().q * exp_so3(theta)).normalized();
    }
    all.push_back(next);
  }
  return all;
}

/// Mean |r| of the rotations, see RotationAligner, at a time offset; infinite unless the attitudes cover half
/// of them.
double mean_residual(const std::vector<CameraRotation>& rotations, const Eigen::Quaterniond& q_b_c,
                     const std::vector<GyroAttitude>& all, double offset_s) {
  struct Residual {
    Eigen::Vector3d r;
    double seconds;
  };
  std::vector<Residual> residuals;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double seconds = 0.0;
  for (const CameraRotation& rotation : rotations) {
    const auto begin = std::ranges::lower_bound(all, after(rotation.begin, offset_s), {}, &GyroAttitude::t);
    const auto end = std::ranges::lower_bound(all, after(rotation.end, offset_s), {}, &GyroAttitude::t);
    if (begin == all.begin() || end == all.end()) continue;
    const Eigen::Quaterniond dq_b = begin->q.conjugate() * end->q;
    const Residual residual{log_so3(dq_b.conjugate() * q_b_c * rotation.dq_c * q_b_c.conjugate()),
                            seconds_between(rotation.begin, rotation.end)};
    residuals.push_back(residual);
    sum += residual.r;
    seconds += residual.seconds;
  }
  if (residuals.empty() || 2 * residuals.size() < rotations.size())
    return std::numeric_limits<double>::infinity();
  double total = 0.0;
  for (const auto& [r, duration] : residuals) total += (r - sum * duration / seconds).norm();
  return total / static_cast<double>(residuals.size());
}

}  // namespace

RotationAligner::RotationAligner(const BackendConfig& config, const Rig& rig)
    : q_b_c_(rig.T_b_c.q),
      time_offset_s_(rig.time_offset_s),
      offset_bound_s_(config.estimate_time_offset ? config.time_offset_bound_s : 0.0) {
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

double RotationAligner::initial_offset(ImuBuffer& imu) const {
  if (offset_is_aligned_ || rotations_.empty() || imu.empty()) return time_offset_s_;
  const std::vector<GyroAttitude> all =
      attitudes(imu.samples_between(after(rotations_.front().begin, time_offset_s_), imu.newest()));
  const auto residual_at = [&](double offset_s) { return mean_residual(rotations_, q_b_c_, all, offset_s); };
  double smallest = kDistinctResidual * residual_at(time_offset_s_), found_s = time_offset_s_;
  const int steps = static_cast<int>(offset_bound_s_ / kOffsetStep_s);
  for (int step = -steps; step <= steps; ++step) {
    const double offset_s = time_offset_s_ + step * kOffsetStep_s;
    const double residual = residual_at(offset_s);
    if (!(residual < smallest)) continue;
    smallest = residual;
    found_s = offset_s;
  }
  return found_s;
}

RotationAlignment RotationAligner::aligned(ImuBuffer& imu) const {
  RotationAlignment found{.q_b_c = q_b_c_, .time_offset_s = initial_offset(imu)};
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const NormalEquations equations = normal_equations(found, imu);
    const Unknowns step = solve_symmetric(equations.H, equations.g);
    found.q_b_c = (found.q_b_c * exp_so3(step.head<3>())).normalized();
    found.time_offset_s += step[3];
    found.gyro_bias += step.tail<3>();
  }
  const SquareMatrix<7> H = normal_equations(found, imu).H;
  found.covariance = solve_symmetric<7, 7>(H, SquareMatrix<7>::Identity()).topLeftCorner<4, 4>();
  Eigen::Vector4d from_rig;
  from_rig << log_so3(q_b_c_.conjugate() * found.q_b_c), found.time_offset_s - time_offset_s_;
  Eigen::Matrix4d tolerated = found.covariance;
  tolerated.diagonal().head<3>().array() += rig_tolerance::kRotation_rad * rig_tolerance::kRotation_rad;
  tolerated(3, 3) += rig_tolerance::kTimeOffset_s * rig_tolerance::kTimeOffset_s;
  found.rig_contradiction = from_rig.dot(solve_symmetric(tolerated, from_rig));
  const Eigen::Vector3d turned = from_rig.head<3>();
  found.rotation_deviations =
      std::sqrt(turned.dot(solve_symmetric<3, 1>(tolerated.topLeftCorner<3, 3>(), turned)) / 3.0);
  found.is_certain = largest_sigma(found.covariance.topLeftCorner<3, 3>()) < kCertainRotation_rad &&
                     found.covariance(3, 3) < kCertainOffset_s * kCertainOffset_s;
  return found;
}

/// With the rotation of the rig. @return nothing if the time offset is not certain
std::optional<RotationAlignment> RotationAligner::align_offset(RotationAlignment initial,
                                                               ImuBuffer& imu) const {
  initial.q_b_c = q_b_c_;
  initial.is_of_offset_alone = true;
  Eigen::Matrix4d H;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const NormalEquations equations = normal_equations(initial, imu);
    H = equations.H.bottomRightCorner<4, 4>();
    const Eigen::Vector4d step = solve_symmetric<4, 1>(H, equations.g.tail<4>());
    initial.time_offset_s += step[0];
    initial.gyro_bias += step.tail<3>();
  }
  const double variance = H.inverse()(0, 0);
  if (!(variance < kCertainOffset_s * kCertainOffset_s)) return std::nullopt;
  initial.rig_contradiction = std::pow(initial.time_offset_s - time_offset_s_, 2) /
                              (variance + rig_tolerance::kTimeOffset_s * rig_tolerance::kTimeOffset_s);
  return initial;
}

std::optional<RotationAlignment> RotationAligner::align(Timestamp now, ImuBuffer& imu) {
  if (!first_) first_ = now;
  const double span = seconds_between(*first_, now);
  if (span < (offset_is_aligned_ ? kMinSpan_s : kMinOffsetSpan_s)) return std::nullopt;
  const RotationAlignment found = aligned(imu);
  if ((found.is_certain && span >= kMinSpan_s) || span >= kMaxSpan_s) return found;
  if (offset_is_aligned_) return std::nullopt;
  std::optional<RotationAlignment> offset_alone = align_offset(found, imu);
  if (!offset_alone) return std::nullopt;
  offset_is_aligned_ = true;
  time_offset_s_ = offset_alone->time_offset_s;
  return offset_alone;
}

namespace {

constexpr double kInterval_s = 0.2;
constexpr double kLongestInterval_s = 0.35;
constexpr int kMinFeatures = 20;

}  // namespace

CameraRotations::CameraRotations(double focal_px)
    : views_({.focal_px = focal_px, .history_s = kLongestInterval_s, .min_agreeing = kMinFeatures}) {}

/// From a view to the newest one.
std::optional<CameraRotation> CameraRotations::since(std::size_t from, const Pose& T_b_c) {
  const std::size_t to = views_.size() - 1;
  const std::optional<VisualPose> moved = views_.pose_after({}, from, to, T_b_c);
  if (!moved) return std::nullopt;
  return CameraRotation{views_[from].stamp, views_[to].stamp,
                        (T_b_c.q.conjugate() * moved->T_w_b.q * T_b_c.q).normalized()};
}

std::vector<CameraRotation> CameraRotations::add(const Window& window) {
  std::vector<CameraRotation> rotations;
  if (!window.frames.back().from_previous || !views_.add(window)) return rotations;
  const std::size_t to = views_.size() - 1;
  const Timestamp now = views_[to].stamp;
  const bool ends_long = seconds_between(long_begin_, now) >= kInterval_s;
  for (std::size_t from = 0; from < to; ++from) {
    const bool begins_long = ends_long && views_[from].stamp == long_begin_;
    if (!begins_long && from + 1 < to) continue;
    if (const auto rotation = since(from, window.T_b_c)) rotations.push_back(*rotation);
  }
  if (ends_long) long_begin_ = now;
  return rotations;
}

}  // namespace stillpoint
