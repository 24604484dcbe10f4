// SPDX-License-Identifier: BSD-3-Clause
/// Noise of the inertial sensors, estimated while running. A data sheet states that of a sensor at rest; the
/// errors of a moving one, by vibration, scale and misalignment of its axes and the delay of its filter, are
/// several times larger: VINS-Mono uses 24 and 40 times the densities of the data sheet for EuRoC, OKVIS 7
/// and 4 times.
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
///   d = v^T S^-1 v  (three dimensions),    log f <- log f + r dt,    1 <= f <= 32,
///   r = r_rise if d > m, else -r_fall,
///
/// so that f settles where d is above m in r_fall / (r_rise + r_fall) of the frames (stochastic approximation
/// of a quantile, Robbins and Monro 1951), and a single event, however large, moves it by no more than any
/// other frame. It follows by a factor of e per second at most. It rises faster than it falls: noise that
/// is too small makes the estimate worse than vision alone, noise that is too large costs little.
///
/// m = 2.37 is the median of the chi-square distribution with three degrees of freedom.
///
/// The errors of the positions of the points are common to the pose by vision and to that of the frame
/// before, from which the prediction starts: they are not part of v. Of the errors of the bearings only the
/// part that changes from frame to frame is (s_w of PixelNoise); with the whole error, S would be four times
/// as large on renderings.
///
/// Errors that white noise does not explain may be those of a bias that changes, by temperature or since the
/// axes have errors of scale: with f, the stated random walk w of the bias becomes
///
///   w <- f w + (f - 1) w_0,    w_0 = 1e-4 rad/s^2/sqrt(Hz) and 0.02 m/s^3/sqrt(Hz).
///
/// An innovation that vision claims too small is attributed to the inertial sensors, too: f is the noise that
/// is consistent with vision, and an upper bound of that of the sensor.
class InertialNoise {
 public:
  /// @param stated densities, of a data sheet or a calibration
  explicit InertialNoise(const ImuNoise& stated) : stated_(stated) {}

  /// @param predicted pose by inertial data
  /// @param visual    pose of the same frame by vision alone, with the covariance of the white noise of its
  ///   bearings
  /// @param dt_s      since the frame before, > 0; more than 0.1 s counts as 0.1 s
  void observe(const UncertainPose& predicted, const UncertainPose& visual, double dt_s);

  /// By the stated densities and the factors, see above.
  [[nodiscard]] ImuNoise densities() const;
  [[nodiscard]] const ImuNoiseFactors& factors() const { return factors_; }

 private:
  ImuNoise stated_;
  ImuNoiseFactors factors_;
};

}  // namespace stillpoint
