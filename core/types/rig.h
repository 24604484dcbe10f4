// SPDX-License-Identifier: BSD-3-Clause
/// Sensors of one robot: inertial samples, noise, and calibration.
#pragma once

#include <Eigen/Core>

#include "core/base/timestamp.h"
#include "core/geometry/camera.h"
#include "core/geometry/pose.h"

namespace stillpoint {

/// Angular rate [rad/s] and specific force [m/s^2] in the body frame, biases included.
struct ImuSample {
  Timestamp t;
  Eigen::Vector3d gyro_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_b = Eigen::Vector3d::Zero();
};

/// Continuous-time noise densities, as given by a data sheet or an Allan deviation plot.
struct ImuNoise {
  double gyro_noise = 1.6e-3;   ///< [rad/s/sqrt(Hz)]
  double accel_noise = 1.6e-2;  ///< [m/s^2/sqrt(Hz)]
  double gyro_walk = 2e-5;      ///< [rad/s^2/sqrt(Hz)]
  double accel_walk = 2e-4;     ///< [m/s^3/sqrt(Hz)]

  bool operator==(const ImuNoise&) const = default;
};

/// Scale and alignment of the axes of the inertial sensors: of a true value x in the body frame a sensor
/// measures
///
///   A x + bias + noise
///
/// with the scales on the diagonal of A, and angles [rad] beside it.
struct ImuAxes {
  Eigen::Matrix3d gyro = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d accel = Eigen::Matrix3d::Identity();

  bool operator==(const ImuAxes&) const = default;

  /// A^-1 times both measurements.
  [[nodiscard]] ImuSample corrected(const ImuSample& measured) const;
};

/// Ratio of the noise densities with which inertial data is used to the stated ones.
struct ImuNoiseFactors {
  double gyro = 1.0;
  double accel = 1.0;
};

/// Counts of irregularities in the IMU stream; reported with the run.
struct ImuHealth {
  int rejected_samples = 0;  ///< not finite, out of order or repeated
  int gaps = 0;              ///< gaps longer than 50 ms in extracted intervals, each counted once
};

/// Calibration.
struct Rig {
  Camera camera;
  double depth_units_per_m = 1000.0;  ///< raw depth value corresponding to 1 m
  /// Measured minus true inverse depth [1/m], by which the depth images of a sequence were corrected when
  /// they were read.
  double depth_offset = 0.0;
  bool has_imu = false;
  Pose T_b_c;  ///< camera to body; identity if there is no IMU
  ImuNoise imu_noise;
  ImuAxes imu_axes;                ///< by which the samples of a sequence were corrected when it was read
  double time_offset_s = 0.0;      ///< IMU time of an exposure minus the timestamp of its image
  double rolling_shutter_s = 0.0;  ///< readout time from the first to the last row; 0 = global shutter
};

/// Calibration to be estimated that has the value of the rig as long as the data does not contradict it:
/// constant in the solve, but with its uncertainty in prior and covariance.
struct AgreesWithRig {
  bool extrinsics = false;
  bool depth_scale = false;
  bool lens = false;

  [[nodiscard]] bool any() const { return extrinsics || depth_scale || lens; }
};

/// The Gauss-Newton step d of the calibration after a solve: what the residuals say about calibration that
/// was constant in it (AgreesWithRig), and how far other calibration is from convergence. With the covariance
/// C of a constant one, d^T C^-1 d is chi-square distributed if the values of the rig are true (score test,
/// Rao 1948).
struct RigStep {
  Eigen::Matrix<double, 6, 1> extrinsics = Eigen::Matrix<double, 6, 1>::Zero();
  double depth_scale = 0.0;  ///< of its inverse
  Eigen::Vector4d lens = Eigen::Vector4d::Zero();
};

/// Rotation of the camera on the body by rotations alone, at the start (RotationAligner).
struct AlignedRotation {
  double difference_rad = 0.0;  ///< from the rig
  double sigma_rad = 0.0;       ///< along the least certain axis
  /// Of the difference d, sqrt(d^T (C + S)^-1 d / 3), with its covariance C and S what a calibration leaves.
  double deviations = 0.0;
};

}  // namespace stillpoint
