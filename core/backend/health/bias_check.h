// SPDX-License-Identifier: BSD-3-Clause
/// Recognition of steps of the inertial biases, by the motion of features between frames.
#pragma once

#include <vector>

#include "core/backend/health/feature_views.h"

namespace stillpoint {

/// Biases that explain the difference between inertial data and vision in about half a second.
struct MeasuredBiases {
  Timestamp t;              ///< end of the interval, on the IMU clock
  Eigen::Vector3d gyro;     ///< in the body frame [rad/s]
  Eigen::Vector3d accel;    ///< same [m/s^2]
  double gyro_sigma = 0.0;  ///< due to the visual poses
  double accel_sigma = 0.0;
  bool certain = false;          ///< whether vision was certain
  bool gyro_explained = false;   ///< whether the data changed by a vector that explains it, see InertialError
  bool accel_explained = false;  ///< same
};

/// Compares the biases of the newest state with those measured between three visual poses, 0.24 s apart. The
/// errors e of a sensor, with standard deviation s due to the poses, are those of a step if successive
/// intervals, each 0.12 s later, have one of the same direction (cosine 0.9), because a step is constant in
/// the body frame:
///
///   intervals   gyroscope [rad/s], vision is certain   accelerometer [m/s^2]
///       1       |e| > 0.05 + 16 s, explained           |e| > 0.2 + 4 s, explained, vision is certain
///       2       |e| > 0.006 + 8 s                      |e| > 0.2 + 3 s, one is explained
///       3                                              |e| > 0.05 + 1.5 s
///       6       |e| > 0.0015 + 2 s
///
/// An explained error is one by which the data changed, see InertialError. An image that jumps gives two
/// errors of one direction, and then two of the opposite one. Each pose is determined by 20 features, an
/// eighth of all that are tracked; vision is certain with 40, a third of all, else people who cover the image
/// look like a step. Features that were labeled static at the earlier pose are used: a step of the
/// accelerometer makes them appear to move, and they lose their label. Errors below 0.003 rad/s and 0.15
/// m/s^2, plus one s, are agreement if vision is certain.
class BiasCheck {
 public:
  /// kDoubtful: they differ, but vision is not certain, so that it may be wrong itself
  enum class Result { kUnknown, kAgrees, kDoubtful, kDiffers, kStep };

  /// @param focal_px of the camera, > 0
  explicit BiasCheck(double focal_px)
      : views_({.focal_px = focal_px,
                .min_interval_s = 0.12,
                .history_s = 0.9,
                .uses_relabeled = true,
                .min_static_ratio = 0.125,
                .min_agreeing = 20}) {}

  /// Processes the newest frame of an inertial window.
  /// @return kUnknown if it is too early for another check, or the error is neither; without certain vision
  /// kUnknown, kDoubtful or kStep
  [[nodiscard]] Result update(const Window& window, ImuBuffer& imu);

  /// The biases measured last; after a result other than kUnknown.
  [[nodiscard]] const MeasuredBiases& measured() const { return measured_.back(); }

  void reset() {
    views_.reset();
    measured_.clear();
  }

 private:
  [[nodiscard]] std::optional<MeasuredBiases> measure(const Window& window, ImuBuffer& imu);

  FeatureViews views_;
  std::vector<MeasuredBiases> measured_;  ///< in succession, the newest ones
};

}  // namespace stillpoint
