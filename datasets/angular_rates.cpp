// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/angular_rates.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"

namespace stillpoint::datasets {
namespace {

constexpr double kMaxTruthInterval_s = 0.1;
constexpr double kMaxSampleInterval_s = 0.1;
constexpr std::size_t kMinPairs = 30;
constexpr double kLagStep_s = 0.005;
constexpr double kMaxRelativeResidual = 0.6;  ///< else the sensors do not see the same rotation
constexpr double kLeastSigma_s = 0.0005;
constexpr int kTrimmings = 3;
constexpr double kMostDrift = 0.01;     ///< of clocks [s/s]
constexpr std::size_t kDriftParts = 8;  ///< at most
constexpr std::size_t kLeastDriftParts = 4;

Eigen::Vector3d residual_of(const RatePair& pair, const Eigen::Matrix3d& R_a_b) {
  return pair.a - R_a_b * pair.b;
}

Eigen::Matrix3d kabsch(std::span<const RatePair> pairs) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const RatePair& pair : pairs) sum += pair.a * pair.b.transpose();
  return closest_rotation(sum).R;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The squared residual of the pairs at a lag.
double residual_at(const RateIntegral& a, std::span<const RateInterval> b, double lag_s) {
  const std::vector<RatePair> pairs = rate_pairs(a, b, lag_s);
  if (pairs.size() < kMinPairs || 2 * pairs.size() < b.size()) return 1.0;
  return fit_rotation(pairs).residual;
}

/// Squares of the residuals at all lags.
std::vector<double> squares_of(const RateIntegral& a, std::span<const RateInterval> b, double range_s) {
  std::vector<double> squares;
  const int steps = static_cast<int>(std::lround(range_s / kLagStep_s));
  for (int step = -steps; step <= steps; ++step)
    squares.push_back(std::pow(residual_at(a, b, step * kLagStep_s), 2));
  return squares;
}

struct Minimum {
  double lag_s = 0.0, residual = 1.0;
};

/// Minimum by steps, refined by the parabola through the squares of three residuals.
Minimum smallest_residual(const RateIntegral& a, std::span<const RateInterval> b, double range_s) {
  const std::vector<double> squares = squares_of(a, b, range_s);
  const int steps = static_cast<int>(squares.size() / 2);
  const auto best = std::ranges::min_element(squares);
  if (best == squares.begin() || best + 1 == squares.end()) return {};
  const double curvature = *(best - 1) - 2.0 * *best + *(best + 1);
  const double fraction = curvature > 0.0 ? 0.5 * (*(best - 1) - *(best + 1)) / curvature : 0.0;
  return {(static_cast<double>(best - squares.begin()) - steps + fraction) * kLagStep_s, std::sqrt(*best)};
}

Timestamp middle_of(std::span<const RateInterval> b) {
  return after(b.front().from, 0.5 * seconds_between(b.front().from, b.back().to));
}

/// The drift [s/s] with which the residuals of short parts have their least sum at one lag of the middle;
/// 0 if no drift gives a common rotation.
double coarse_drift(const RateIntegral& a, std::span<const RateInterval> b, double range_s) {
  const std::size_t parts = std::min(kDriftParts, b.size() / kMinPairs);
  if (parts < kLeastDriftParts) return 0.0;
  std::vector<std::vector<double>> squares;
  std::vector<double> from_middle_s;
  for (std::size_t k = 0; k < parts; ++k) {
    const std::span<const RateInterval> part = b.subspan(k * b.size() / parts, b.size() / parts);
    squares.push_back(squares_of(a, part, range_s));
    from_middle_s.push_back(seconds_between(middle_of(b), middle_of(part)));
  }
  const double step = kLagStep_s / seconds_between(b.front().from, b.back().to);
  const int steps = static_cast<int>(kMostDrift / step), lags = static_cast<int>(squares[0].size());
  double least = static_cast<double>(parts) * kMaxRelativeResidual * kMaxRelativeResidual, drift = 0.0;
  for (int i = -steps; i <= steps; ++i) {
    for (int lag = 0; lag < lags; ++lag) {
      double sum = 0.0;
      for (std::size_t k = 0; k < parts; ++k) {
        const int at = lag + static_cast<int>(std::lround(i * step * from_middle_s[k] / kLagStep_s));
        sum += at >= 0 && at < lags ? squares[k][static_cast<std::size_t>(at)] : 1.0;
      }
      if (sum >= least) continue;
      least = sum;
      drift = i * step;
    }
  }
  return drift;
}

/// Without a drift by more than a period of the rotation.
std::optional<LagFit> fit_steady_lag(const RateIntegral& a, std::span<const RateInterval> b, double range_s) {
  if (b.size() < 3 * kMinPairs) return std::nullopt;
  const Minimum whole = smallest_residual(a, b, range_s);
  if (whole.residual > kMaxRelativeResidual) return std::nullopt;
  LagFit fit{.lag_s = whole.lag_s, .residual = whole.residual, .without = residual_at(a, b, 0.0)};
  std::array<Minimum, 3> parts;
  double squares = 0.0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const std::span<const RateInterval> part = b.subspan(k * b.size() / 3, b.size() / 3);
    parts[k] = smallest_residual(a, part, range_s);
    if (parts[k].residual > kMaxRelativeResidual) return fit;
    squares += std::pow(parts[k].lag_s - whole.lag_s, 2);
  }
  fit.sigma_s = std::max(kLeastSigma_s, std::sqrt(squares / 6.0));  // deviation of the mean of three
  const double apart_s = seconds_between(b.front().from, b.back().to) * 2.0 / 3.0;
  const double straightness_s = std::abs(parts[1].lag_s - 0.5 * (parts[0].lag_s + parts[2].lag_s));
  fit.drift_ppm = 1e6 * (parts[2].lag_s - parts[0].lag_s) / apart_s;
  fit.drift_sigma_ppm = 1e6 * std::max(kLeastSigma_s, straightness_s) * M_SQRT2 / apart_s;
  return fit;
}

}  // namespace

RateIntegral::RateIntegral(std::span<const ImuSample> samples) {
  for (const ImuSample& sample : samples) {
    const double interval_s = times_.empty() ? 0.0 : seconds_between(times_.back(), sample.t);
    const Eigen::Vector3d before = times_.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : angles_.back();
    const Eigen::Vector3d last = times_.empty() ? sample.gyro_b : samples[times_.size() - 1].gyro_b;
    times_.push_back(sample.t);
    angles_.emplace_back(before + 0.5 * interval_s * (last + sample.gyro_b));
    gap_before_.push_back(interval_s > kMaxSampleInterval_s);
  }
}

RateIntegral::RateIntegral(const Trajectory& trajectory) {
  for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
    const StampedPose& pose = trajectory.poses[i];
    Eigen::Vector3d angle = Eigen::Vector3d::Zero();
    double interval_s = 0.0;
    if (i > 0) {
      const StampedPose& last = trajectory.poses[i - 1];
      interval_s = seconds_between(last.t, pose.t);
      angle = angles_.back() + log_so3(last.T_w_f.q.conjugate() * pose.T_w_f.q);
    }
    times_.push_back(pose.t);
    angles_.push_back(angle);
    gap_before_.push_back(interval_s > kMaxTruthInterval_s);
  }
}

std::optional<Eigen::Vector3d> RateIntegral::at(Timestamp t) const {
  const auto next = std::ranges::lower_bound(times_, t);
  if (next == times_.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(next - times_.begin());
  if (times_[i] == t) return angles_[i];
  if (i == 0 || gap_before_[i]) return std::nullopt;
  const double fraction = seconds_between(times_[i - 1], t) / seconds_between(times_[i - 1], times_[i]);
  return angles_[i - 1] + fraction * (angles_[i] - angles_[i - 1]);
}

std::optional<Eigen::Vector3d> RateIntegral::mean(Timestamp from, Timestamp to) const {
  const std::optional<Eigen::Vector3d> begin = at(from), end = at(to);
  if (!begin || !end || !(from < to)) return std::nullopt;
  return (*end - *begin) / seconds_between(from, to);
}

std::vector<RateInterval> rates_between(const RateIntegral& integral, std::span<const Timestamp> times) {
  std::vector<RateInterval> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (const auto rate = integral.mean(times[i - 1], times[i]))
      intervals.push_back({times[i - 1], times[i], *rate});
  }
  return intervals;
}

std::vector<RatePair> rate_pairs(const RateIntegral& a, std::span<const RateInterval> b, double lag_s) {
  std::vector<RatePair> pairs;
  pairs.reserve(b.size());
  for (const RateInterval& interval : b) {
    if (const auto rate = a.mean(after(interval.from, lag_s), after(interval.to, lag_s)))
      pairs.push_back({*rate, interval.rate});
  }
  return pairs;
}

double relative_residual(std::span<const RatePair> pairs, const Eigen::Matrix3d& R_a_b) {
  if (pairs.empty()) return 1.0;
  std::vector<std::array<double, 2>> squares;
  squares.reserve(pairs.size());
  for (const RatePair& pair : pairs)
    squares.push_back({residual_of(pair, R_a_b).squaredNorm(), pair.a.squaredNorm()});
  std::ranges::sort(squares);
  double residual = 0.0, rate = 0.0;
  for (std::size_t i = 0; i < (3 * squares.size() + 3) / 4; ++i) {
    residual += squares[i][0];
    rate += squares[i][1];
  }
  return rate > 0.0 ? std::sqrt(residual / rate) : 1.0;
}

double rate_ratio(std::span<const RatePair> pairs) {
  double product = 0.0, squares = 0.0;
  for (const RatePair& pair : pairs) {
    product += pair.a.norm() * pair.b.norm();
    squares += pair.b.squaredNorm();
  }
  return squares > 0.0 ? product / squares : 1.0;
}

RotationFit fit_rotation(std::vector<RatePair> pairs) {
  RotationFit fit;
  fit.sigma_rad.setConstant(M_PI);
  if (pairs.size() < kMinPairs) return fit;
  const std::vector<RatePair> all = pairs;
  Eigen::Matrix3d R = kabsch(pairs);
  for (int i = 0; i < kTrimmings; ++i) {
    std::vector<double> norms;
    norms.reserve(all.size());
    for (const RatePair& pair : all) norms.push_back(residual_of(pair, R).norm());
    const double limit = 3.0 * median_of(norms);
    pairs = all;
    std::erase_if(pairs, [&](const RatePair& pair) { return residual_of(pair, R).norm() > limit; });
    R = kabsch(pairs);
  }
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  double squares = 0.0;
  for (const RatePair& pair : pairs) {
    const Eigen::Matrix3d J = skew(R * pair.b);
    H += J.transpose() * J;
    squares += residual_of(pair, R).squaredNorm() / (3.0 * static_cast<double>(pairs.size()));
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(H);
  const Eigen::Vector3d inverse = solver.eigenvalues().cwiseMax(1e-12).cwiseInverse();
  const Eigen::Matrix3d covariance =
      squares * solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
  fit.q_a_b = Eigen::Quaterniond(R).normalized();
  fit.sigma_rad = covariance.diagonal().cwiseSqrt().cwiseMin(M_PI);
  fit.residual = relative_residual(all, R);
  return fit;
}

std::optional<LagFit> fit_lag(const RateIntegral& a, std::span<const RateInterval> b, double range_s) {
  if (std::optional<LagFit> steady = fit_steady_lag(a, b, range_s)) return steady;
  const double drift = coarse_drift(a, b, range_s);
  if (drift == 0.0) return std::nullopt;
  const Timestamp middle = middle_of(b);
  std::vector<RateInterval> moved(b.begin(), b.end());
  for (RateInterval& interval : moved) {
    interval.from = after(interval.from, drift * seconds_between(middle, interval.from));
    interval.to = after(interval.to, drift * seconds_between(middle, interval.to));
  }
  std::optional<LagFit> fit = fit_steady_lag(a, moved, range_s);
  if (!fit) return std::nullopt;
  const double thirds_s = drift * seconds_between(b.front().from, b.back().to) / 3.0;
  fit->sigma_s = std::hypot(fit->sigma_s, thirds_s / std::sqrt(3.0));  // as without the drift
  fit->without = residual_at(a, b, 0.0);
  fit->drift_ppm += 1e6 * drift;
  return fit;
}

const std::array<Eigen::Matrix3d, 48>& axis_permutations() {
  static const std::array<Eigen::Matrix3d, 48> kAll = [] {
    std::array<Eigen::Matrix3d, 48> all;
    std::array<int, 3> order{0, 1, 2};
    std::size_t next = 0;
    do {
      for (int signs = 0; signs < 8; ++signs) {
        Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
        for (int row = 0; row < 3; ++row)
          P(row, order[static_cast<std::size_t>(row)]) = (signs >> row) % 2 == 0 ? 1.0 : -1.0;
        all[next++] = P;
      }
    } while (std::ranges::next_permutation(order).found);
    return all;
  }();
  return kAll;
}

std::string permutation_text(const Eigen::Matrix3d& P) {
  std::string text;
  for (int row = 0; row < 3; ++row) {
    Eigen::Index axis = 0;
    P.row(row).cwiseAbs().maxCoeff(&axis);
    text += fmt::format("{}{}{}", row == 0 ? "" : ", ", P(row, axis) < 0.0 ? "-" : "", "xyz"[axis]);
  }
  return "(x, y, z) <- (" + text + ")";
}

}  // namespace stillpoint::datasets
