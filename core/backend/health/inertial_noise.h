// SPDX-License-Identifier: BSD-3-Clause
/// Noise of the inertial sensors, estimated while running. A data sheet states that of a sensor at rest; the
/// errors of a moving one, by vibration, scale and misalignment of its axes and the delay of its filter, are
/// several times larger (real_sensors: factors 2 to 16 at EuRoC, which VINS-Mono and OKVIS set by hand).
#pragma once

#include "core/geometry/covariance.h"
#include "core/types/rig.h"

namespace stillpoint {

/// Factors on the stated densities of the gyroscope and of the accelerometer, white noise and random walk.
///
/// For each frame, the innovation v of the pose by vision alone at the pose predicted by inertial data has
/// the covariance S, the sum of both. Its rotation tells about the gyroscope, its position about the
/// accelerometer; of each,
///
///   d = v^T S^-1 v  (three dimensions),    log f <- log f + r dt sgn(d - m),    1 <= f <= 32,
///
/// with the median m = 2.366 of the chi-square distribution with three degrees of freedom. So f settles
/// where half of the innovations are below their median (stochastic approximation of a quantile, Robbins and
/// Monro 1951), and a single event, however large, moves it by no more than any other frame. The factor rises
/// faster than it falls, r_up > r_down: noise that is too small makes the estimate worse than vision alone,
/// noise that is too large costs little.
class InertialNoise {
 public:
  /// @param stated densities, of a data sheet or a calibration
  explicit InertialNoise(const ImuNoise& stated) : stated_(stated) {}

  /// @param predicted pose by inertial data
  /// @param visual    pose of the same frame by vision alone
  /// @param dt_s      since the frame before, > 0
  void observe(const UncertainPose& predicted, const UncertainPose& visual, double dt_s);

  /// The stated densities times the factors.
  [[nodiscard]] ImuNoise densities() const;
  [[nodiscard]] const ImuNoiseFactors& factors() const { return factors_; }

 private:
  ImuNoise stated_;
  ImuNoiseFactors factors_;
};

}  // namespace stillpoint
