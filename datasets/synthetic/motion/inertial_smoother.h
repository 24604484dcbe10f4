// SPDX-License-Identifier: BSD-3-Clause
/// Smooth path from noisy motion-capture poses and the IMU samples recorded with them, if there are any.
///
/// Motion capture is accurate at low frequencies, but has per-sample noise and gaps; the IMU is accurate at
/// high frequencies, but drifts. A quintic B-spline is fitted to both by linear least squares, whose normal
/// matrix is banded: to the poses, to the angular rates, dq/dt = q * (w - b_w) / 2 (linear in q), and to the
/// accelerations, p'' = R (a - b_a) + g (linear in p). q, R: attitude T_w_b; w, a: gyroscope and
/// accelerometer samples; b: their biases, estimated in alternation with the fit. Continuous-time fusion
/// after Furgale, Barfoot and Sibley (2012).
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/timestamp.h"
#include "core/types/rig.h"
#include "core/types/trajectory.h"
#include "datasets/synthetic/motion/path_spline.h"

namespace stillpoint::synth {

/// Accumulates the normal equations A^T W A x = A^T W b in band storage and solves them by banded Cholesky
/// factorization (Golub and Van Loan, 4.3).
class BandedLeastSquares {
 public:
  /// @param unknowns number of unknowns @param band maximum row length @param columns number of right-hand
  /// sides
  BandedLeastSquares(int unknowns, int band, int columns);

  /// Adds weight * |row * x[first, first + row.size()) - value|^2 for each column of x; `value` has one
  /// number per column.
  void add(int first, std::span<const double> row, std::span<const double> value, double weight);

  /// @return unknowns x columns. The rows added must determine every unknown.
  [[nodiscard]] Eigen::MatrixXd solve() const;

 private:
  Eigen::MatrixXd normal_;  // (i - j, j) holds entry (i, j), i >= j
  Eigen::MatrixXd rhs_;
};

/// Standard deviations per sample, and fit parameters.
struct SmootherConfig {
  double knot_interval_s = 0.01;
  double position_sigma_m = 0.002;
  double rotation_sigma = 0.01;  ///< [rad]
  double gyro_sigma = 0.01;      ///< including the vibration of a drone [rad/s]
  double accel_sigma = 0.15;     ///< including the vibration of a drone [m/s^2]
  int iterations = 10;           ///< alternations of path fit and bias estimation
};

struct SmoothedMotion {
  PathSpline path;  ///< time 0 = epoch
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  // Root mean square of the residual norms, bias subtracted.
  double position_residual_m = 0.0;
  double rotation_residual = 0.0;  ///< [rad]
  double gyro_residual = 0.0;      ///< [rad/s]
  double accel_residual = 0.0;     ///< [m/s^2]
};

struct MotionSamples {
  std::span<const StampedPose> poses;  ///< T_w_b of the IMU
  std::span<const ImuSample> imu;
  Timestamp epoch;
  double from_s = 0.0;  ///< interval after the epoch that both cover; a small margin at both ends helps
  double to_s = 0.0;
};

/// Without IMU samples, the knot interval alone determines the smoothness.
[[nodiscard]] SmoothedMotion smooth_motion(const MotionSamples& samples, const SmootherConfig& config = {});

}  // namespace stillpoint::synth
