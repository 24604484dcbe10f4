// SPDX-License-Identifier: BSD-3-Clause
/// Recognition of steps of the inertial biases, by the motion of features between frames.
#pragma once

#include "core/backend/health/feature_views.h"

namespace stillpoint {

/// Biases that explain the difference between inertial data and vision in about half a second.
struct MeasuredBiases {
  Timestamp t;              ///< end of the interval, on the IMU clock
  Eigen::Vector3d gyro;     ///< in the body frame [rad/s]
  Eigen::Vector3d accel;    ///< same [m/s^2]
  double gyro_sigma = 0.0;  ///< due to the visual poses
  double accel_sigma = 0.0;
};

/// Compares the biases of the newest state with those measured between three visual poses, 0.24 s apart:
///
///   error of the gyroscope        e > 0.006 rad/s + 8 sigma
///   error of the accelerometer    e > 0.05 m/s^2 + 4 sigma
///
/// Such an error is a step of the bias if the previous interval, which began 0.12 s before, had one of the
/// same direction (cosine 0.9), because a step is constant in the body frame. Vision must be certain: each
/// pose is determined by 40 features, a third of all that are tracked, else people who cover the image look
/// like a step. Errors below 0.008 rad/s and 0.15 m/s^2, plus one sigma, are agreement.
class BiasCheck {
 public:
  enum class Result { kUnknown, kAgrees, kDiffers, kStep };

  /// @param focal_px of the camera, > 0
  explicit BiasCheck(double focal_px)
      : views_({.focal_px = focal_px,
                .min_interval_s = 0.12,
                .history_s = 0.9,
                .min_static_ratio = 0.33,
                .min_agreeing = 40}) {}

  /// Processes the newest frame of an inertial window.
  /// @return kUnknown if it is too early for another check, vision is not certain, or the error is neither
  [[nodiscard]] Result update(const Window& window, ImuBuffer& imu);

  /// The biases measured last; after a result other than kUnknown.
  [[nodiscard]] const MeasuredBiases& measured() const { return *measured_; }

  void reset() {
    views_.reset();
    measured_.reset();
  }

 private:
  [[nodiscard]] std::optional<MeasuredBiases> measure(const Window& window, ImuBuffer& imu);

  FeatureViews views_;
  std::optional<MeasuredBiases> measured_;
};

}  // namespace stillpoint
