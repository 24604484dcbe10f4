// SPDX-License-Identifier: BSD-3-Clause
/// Compares the angular rates of two sensors: rotation between them, lag, and axes that are swapped or
/// inverted.
///
/// With the mean rates a_k and b_k of the sensors over the same intervals, R_a_b minimizes
///   sum_k |a_k - R_a_b b_k|^2
/// (Kabsch 1976; Horn 1987) over the pairs that are left after those beyond three times the median residual
/// were removed: people who fill an image turn unlike the gyroscope.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/timestamp.h"
#include "core/types/rig.h"
#include "core/types/trajectory.h"

namespace stillpoint::datasets {

/// The mean angular rate of a sensor over any interval.
class RateIntegral {
 public:
  /// Of the gyroscope, in the body frame; rates between samples are interpolated linearly.
  explicit RateIntegral(std::span<const ImuSample> samples);
  /// Of a trajectory, in the frame of its poses. Poses more than 0.1 s apart leave a gap.
  explicit RateIntegral(const Trajectory& trajectory);

  /// @return nullopt outside of the samples, and where the interval touches a gap
  [[nodiscard]] std::optional<Eigen::Vector3d> mean(Timestamp from, Timestamp to) const;

 private:
  [[nodiscard]] std::optional<Eigen::Vector3d> at(Timestamp t) const;

  std::vector<Timestamp> times_;
  std::vector<Eigen::Vector3d> angles_;  ///< integral of the rate from the first sample on
  std::vector<bool> gap_before_;
};

/// The rate of a sensor over an interval.
struct RateInterval {
  Timestamp from, to;
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
};

/// Mean rates between successive times, without those of gaps.
[[nodiscard]] std::vector<RateInterval> rates_between(const RateIntegral& integral,
                                                      std::span<const Timestamp> times);

/// Mean rates of two sensors over the same interval.
struct RatePair {
  Eigen::Vector3d a, b;
};

/// Pairs (mean of `a` over the interval moved by `lag_s`, rate of the interval).
[[nodiscard]] std::vector<RatePair> rate_pairs(const RateIntegral& a, std::span<const RateInterval> b,
                                               double lag_s);

/// Root mean square of a - R b over the three quarters of the pairs with the smallest residuals, relative to
/// that of a over the same pairs. 1 without pairs.
[[nodiscard]] double relative_residual(std::span<const RatePair> pairs, const Eigen::Matrix3d& R_a_b);

/// Sum |a| |b| / sum |b|^2.
[[nodiscard]] double rate_ratio(std::span<const RatePair> pairs);

struct RotationFit {
  Eigen::Quaterniond q_a_b = Eigen::Quaterniond::Identity();
  Eigen::Vector3d sigma_rad = Eigen::Vector3d::Zero();  ///< about the axes of a; large if not observed
  double residual = 1.0;                                ///< as `relative_residual`
};
[[nodiscard]] RotationFit fit_rotation(std::vector<RatePair> pairs);

/// A lag of a sensor behind another one.
struct LagFit {
  double lag_s = 0.0;      ///< stamp of an event by a minus that by b
  double sigma_s = 1.0;    ///< from the difference between parts of the recording
  double residual = 1.0;   ///< of the rotation fit, with the lag
  double without = 1.0;    ///< same, without a lag
  double drift_ppm = 0.0;  ///< by the lag in the first and last third
  double drift_sigma_ppm = 1e6;
};

/// The lag with the smallest residual, by steps of 5 ms and a parabola. Clocks that drift by so much that no
/// lag fits are compared in short parts first, with drifts of up to 1 %.
/// @return nullopt without motion that determines it
[[nodiscard]] std::optional<LagFit> fit_lag(const RateIntegral& a, std::span<const RateInterval> b,
                                            double range_s);

/// The 48 matrices that permute and invert axes, the identity first.
[[nodiscard]] const std::array<Eigen::Matrix3d, 48>& axis_permutations();

/// "(x, y, z) -> (y, -x, z)": rows of the matrix.
[[nodiscard]] std::string permutation_text(const Eigen::Matrix3d& P);

}  // namespace stillpoint::datasets
