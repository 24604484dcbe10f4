// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/motion/inertial_smoother.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/base/error.h"
#include "core/geometry/so3.h"

namespace stillpoint::synth {

BandedLeastSquares::BandedLeastSquares(int unknowns, int band, int columns)
    : normal_(Eigen::MatrixXd::Zero(band, unknowns)), rhs_(Eigen::MatrixXd::Zero(unknowns, columns)) {}

void BandedLeastSquares::add(int first, std::span<const double> row, std::span<const double> value,
                             double weight) {
  const int width = static_cast<int>(row.size());
  STILLPOINT_CHECK(width <= normal_.rows() && first >= 0 && first + width <= normal_.cols());
  for (int j = 0; j < width; ++j) {
    const double weighted = weight * row[static_cast<std::size_t>(j)];
    if (weighted == 0.0) continue;
    for (int i = j; i < width; ++i) normal_(i - j, first + j) += weighted * row[static_cast<std::size_t>(i)];
    for (std::size_t c = 0; c < value.size(); ++c)
      rhs_(first + j, static_cast<Eigen::Index>(c)) += weighted * value[c];
  }
}

Eigen::MatrixXd BandedLeastSquares::solve() const {
  const Eigen::Index count = normal_.cols(), band = normal_.rows();
  Eigen::MatrixXd factor = normal_;
  Eigen::MatrixXd x = rhs_;
  for (Eigen::Index j = 0; j < count; ++j) {
    STILLPOINT_CHECK(factor(0, j) > 0.0);
    const Eigen::Index below = std::min(band - 1, count - 1 - j);
    factor.col(j).head(below + 1) /= std::sqrt(factor(0, j));
    for (Eigen::Index k = 1; k <= below; ++k) {
      factor.col(j + k).head(below - k + 1) -= factor(k, j) * factor.col(j).segment(k, below - k + 1);
    }
    x.row(j) /= factor(0, j);
    for (Eigen::Index k = 1; k <= below; ++k) x.row(j + k) -= factor(k, j) * x.row(j);
  }
  for (Eigen::Index j = count - 1; j >= 0; --j) {
    const Eigen::Index below = std::min(band - 1, count - 1 - j);
    for (Eigen::Index k = 1; k <= below; ++k) x.row(j) -= factor(k, j) * x.row(j + k);
    x.row(j) /= factor(0, j);
  }
  return x;
}

namespace {

constexpr double kSmoothnessWeight =
    1e-3;  // weight of third differences of control points; bridges gaps without samples

/// The knots of a spline over [from_s, to_s].
struct Knots {
  double start_s, interval_s;
  int count;

  struct Span {
    int first;
    double u;
  };
  [[nodiscard]] Span span_at(double t_s) const {
    const double knots = std::clamp((t_s - start_s) / interval_s - 2.0, 0.0, count - 6 + 1.0 - 1e-9);
    return {static_cast<int>(knots), knots - std::floor(knots)};
  }
};

Knots knots_over(double from_s, double to_s, double interval_s) {
  const int spans = static_cast<int>(std::ceil((to_s - from_s) / interval_s));
  return {from_s - 2.0 * interval_s, interval_s, spans + 6};
}

/// Inputs in seconds since the epoch.
struct Problem {
  std::span<const StampedPose> poses;
  std::span<const ImuSample> imu;
  Timestamp epoch;
  Knots knots;
  SmootherConfig config;
};

void add_smoothness(BandedLeastSquares& system, int count, int dimension, int columns) {
  const std::vector<double> zero(static_cast<std::size_t>(columns), 0.0);
  for (int i = 0; i + 3 < count; ++i) {
    for (int d = 0; d < dimension; ++d) {
      std::vector<double> row(static_cast<std::size_t>(3 * dimension + 1));
      const std::array<double, 4> difference{-1.0, 3.0, -3.0, 1.0};
      for (std::size_t k = 0; k < 4; ++k) row[k * static_cast<std::size_t>(dimension)] = difference[k];
      system.add(i * dimension + d, row, zero, kSmoothnessWeight);
    }
  }
}

/// sum_k (scalar_k * I + coupling * coupled_k) c_k = target, c_k: the quaternion of knot first + k.
struct QuaternionCondition {
  int first;
  std::array<double, 6> scalar;
  std::array<double, 6> coupled;
  Eigen::Matrix4d coupling;
  Eigen::Vector4d target;
  double weight;
};

/// One row per quaternion number.
void add_quaternion_rows(BandedLeastSquares& system, const QuaternionCondition& condition) {
  const auto& [first, scalar, coupled, coupling, target, weight] = condition;
  for (int r = 0; r < 4; ++r) {
    std::array<double, 24> row{};
    for (std::size_t k = 0; k < 6; ++k) {
      for (int c = 0; c < 4; ++c) {
        row[4 * k + static_cast<std::size_t>(c)] = (r == c ? scalar[k] : 0.0) + coupled[k] * coupling(r, c);
      }
    }
    system.add(4 * first, row, std::span(target.data() + r, 1), weight);
  }
}

/// q * (w, 0) as a matrix that acts on the numbers x y z w of q.
Eigen::Matrix4d right_product(const Eigen::Vector3d& w) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  matrix.topLeftCorner<3, 3>() = -skew(w);
  matrix.topRightCorner<3, 1>() = w;
  matrix.bottomLeftCorner<1, 3>() = -w.transpose();
  return matrix;
}

std::vector<Eigen::Vector4d> fit_attitudes(const Problem& problem, const Eigen::Vector3d& gyro_bias) {
  const Knots& knots = problem.knots;
  BandedLeastSquares system(4 * knots.count, 24, 1);
  const double pose_weight =
      std::pow(2.0 / problem.config.rotation_sigma, 2);  // a quaternion turns by half angles
  Eigen::Vector4d previous = problem.poses.front().T_w_f.q.coeffs();
  for (const StampedPose& pose : problem.poses) {
    Eigen::Vector4d q = pose.T_w_f.q.coeffs();
    if (q.dot(previous) < 0.0) q = -q;
    previous = q;
    const Knots::Span span = knots.span_at(seconds_between(problem.epoch, pose.t));
    add_quaternion_rows(
        system, {span.first, quintic_weights(span.u, 0), {}, Eigen::Matrix4d::Zero(), q, pose_weight});
  }
  const double gyro_weight = std::pow(2.0 / problem.config.gyro_sigma, 2);
  for (const ImuSample& sample : problem.imu) {
    const Knots::Span span = knots.span_at(seconds_between(problem.epoch, sample.t));
    std::array<double, 6> rate = quintic_weights(span.u, 1);
    for (double& weight : rate) weight /= knots.interval_s;
    add_quaternion_rows(
        system, {span.first, rate, quintic_weights(span.u, 0),
                 -0.5 * right_product(sample.gyro_b - gyro_bias), Eigen::Vector4d::Zero(), gyro_weight});
  }
  add_smoothness(system, knots.count, 4, 1);
  const Eigen::MatrixXd solution = system.solve();
  std::vector<Eigen::Vector4d> attitudes;
  attitudes.reserve(static_cast<std::size_t>(knots.count));
  for (int i = 0; i < knots.count; ++i) attitudes.emplace_back(solution.block<4, 1>(Eigen::Index{4} * i, 0));
  return attitudes;
}

/// Accelerometer bias in the body frame, and the tilt error of the world's vertical.
struct AccelError {
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d tilt_w = Eigen::Vector3d::Zero();
};

Eigen::Vector3d acceleration_of(const ImuSample& sample, const Eigen::Quaterniond& q_w_b,
                                const AccelError& error) {
  return q_w_b * (sample.accel_b - error.bias) - Eigen::Vector3d(0.0, 0.0, kGravity) + error.tilt_w;
}

std::vector<Eigen::Vector3d> fit_positions(const Problem& problem, const PathSpline& attitude,
                                           const AccelError& error) {
  const Knots& knots = problem.knots;
  BandedLeastSquares system(knots.count, 6, 3);
  for (const StampedPose& pose : problem.poses) {
    const Knots::Span span = knots.span_at(seconds_between(problem.epoch, pose.t));
    system.add(span.first, quintic_weights(span.u, 0), std::span(pose.T_w_f.p.data(), 3),
               std::pow(problem.config.position_sigma_m, -2));
  }
  for (const ImuSample& sample : problem.imu) {
    const double t_s = seconds_between(problem.epoch, sample.t);
    const Knots::Span span = knots.span_at(t_s);
    std::array<double, 6> second = quintic_weights(span.u, 2);
    for (double& weight : second) weight /= knots.interval_s * knots.interval_s;
    const Eigen::Vector3d acceleration = acceleration_of(sample, attitude.pose_at(t_s).q, error);
    system.add(span.first, second, std::span(acceleration.data(), 3),
               std::pow(problem.config.accel_sigma, -2));
  }
  add_smoothness(system, knots.count, 1, 3);
  const Eigen::MatrixXd solution = system.solve();
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(static_cast<std::size_t>(knots.count));
  for (int i = 0; i < knots.count; ++i) positions.emplace_back(solution.row(i).transpose());
  return positions;
}

Eigen::Vector3d mean_gyro_error(const Problem& problem, const PathSpline& path) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : problem.imu) {
    sum += sample.gyro_b - path.at(seconds_between(problem.epoch, sample.t)).rate_b;
  }
  return sum / std::max(static_cast<double>(problem.imu.size()), 1.0);
}

/// Least squares for bias and tilt in  p'' = R (a - bias) + g + tilt.
AccelError fit_accel_error(const Problem& problem, const PathSpline& path) {
  Eigen::Matrix<double, 5, 5> normal =
      Eigen::Matrix<double, 5, 5>::Identity();  // 1: weak prior against 1e3 samples
  Eigen::Matrix<double, 5, 1> rhs = Eigen::Matrix<double, 5, 1>::Zero();
  for (const ImuSample& sample : problem.imu) {
    const BodyMotion motion = path.at(seconds_between(problem.epoch, sample.t));
    Eigen::Matrix<double, 3, 5> jacobian;
    jacobian.leftCols<3>() = -motion.T_w_b.R();
    jacobian.rightCols<2>() = Eigen::Matrix<double, 3, 2>::Identity();
    const Eigen::Vector3d residual = motion.acceleration_w - acceleration_of(sample, motion.T_w_b.q, {});
    normal += jacobian.transpose() * jacobian;
    rhs += jacobian.transpose() * residual;
  }
  const Eigen::Matrix<double, 5, 1> solution = normal.ldlt().solve(rhs);
  return {solution.head<3>(), Eigen::Vector3d(solution[3], solution[4], 0.0)};
}

SmoothedMotion with_residuals(const Problem& problem, PathSpline path, const Eigen::Vector3d& gyro_bias,
                              const AccelError& accel) {
  SmoothedMotion result{.path = std::move(path), .gyro_bias = gyro_bias, .accel_bias = accel.bias};
  double position = 0.0, rotation = 0.0, gyro = 0.0, acceleration = 0.0;
  for (const StampedPose& pose : problem.poses) {
    const Pose smooth = result.path.pose_at(seconds_between(problem.epoch, pose.t));
    position += (smooth.p - pose.T_w_f.p).squaredNorm();
    rotation += log_so3(smooth.q.conjugate() * pose.T_w_f.q).squaredNorm();
  }
  for (const ImuSample& sample : problem.imu) {
    const BodyMotion motion = result.path.at(seconds_between(problem.epoch, sample.t));
    gyro += (sample.gyro_b - gyro_bias - motion.rate_b).squaredNorm();
    acceleration += (acceleration_of(sample, motion.T_w_b.q, accel) - motion.acceleration_w).squaredNorm();
  }
  const auto poses = static_cast<double>(problem.poses.size()),
             samples = std::max(static_cast<double>(problem.imu.size()), 1.0);
  result.position_residual_m = std::sqrt(position / poses);
  result.rotation_residual = std::sqrt(rotation / poses);
  result.gyro_residual = std::sqrt(gyro / samples);
  result.accel_residual = std::sqrt(acceleration / samples);
  return result;
}

}  // namespace

SmoothedMotion smooth_motion(const MotionSamples& samples, const SmootherConfig& config) {
  const Knots knots = knots_over(samples.from_s, samples.to_s, config.knot_interval_s);
  const Problem problem{samples.poses, samples.imu, samples.epoch, knots, config};
  const std::vector<Eigen::Vector3d> zero_positions(static_cast<std::size_t>(knots.count),
                                                    Eigen::Vector3d::Zero());
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  AccelError accel;
  PathSpline path(knots.start_s, knots.interval_s, zero_positions, fit_attitudes(problem, gyro_bias));
  const int iterations = samples.imu.empty() ? 1 : config.iterations;
  for (int i = 0; i < iterations; ++i) {
    gyro_bias = mean_gyro_error(problem, path);
    std::vector<Eigen::Vector4d> attitudes = fit_attitudes(problem, gyro_bias);
    const PathSpline rotation_path(knots.start_s, knots.interval_s, zero_positions, attitudes);
    path = PathSpline(knots.start_s, knots.interval_s, fit_positions(problem, rotation_path, accel),
                      std::move(attitudes));
    accel = fit_accel_error(problem, path);
  }
  return with_residuals(problem, std::move(path), gyro_bias, accel);
}

}  // namespace stillpoint::synth
