// SPDX-License-Identifier: BSD-3-Clause
/// Detection of inertial data that becomes wrong, by the motion of features between frames.
#pragma once

#include "core/backend/health/feature_views.h"

namespace stillpoint {

/// Recognizes wrong data before it is used to label moving features. The data of about 0.13 s is wrong if it
/// errs by 1.5 m/s^2 or 0.05 rad/s, each plus two standard deviations, and its change explains the error, see
/// `InertialError`.
class StepCheck {
 public:
  /// @param focal_px of the camera, > 0
  explicit StepCheck(double focal_px) : views_({.focal_px = focal_px}) {}

  /// Processes the newest frame of an inertial window at its predicted pose. Landmarks labeled dynamic so far
  /// are left out. Visual poses are computed only if the data changed by 1.5 m/s^2 or 0.05 rad/s.
  /// @return whether its inertial data is wrong
  [[nodiscard]] bool is_wrong(const Window& window, ImuBuffer& imu);

  void reset() { views_.reset(); }

 private:
  [[nodiscard]] bool data_changed(std::size_t first, std::size_t middle) const;

  FeatureViews views_;
};

/// Recognizes a step of the biases, by the data of half a second, after labels were derived from it. Half of
/// the features must agree with the visual motion, so that a person in front of the camera is not mistaken
/// for the static scene.
class BiasCheck {
 public:
  /// @param focal_px of the camera, > 0
  explicit BiasCheck(double focal_px)
      : views_({.focal_px = focal_px, .min_interval_s = 0.24, .history_s = 0.9, .min_static_ratio = 0.33}) {}

  /// Processes the newest frame of an inertial window.
  /// @return nullopt if it is too early for another check, or vision does not determine the motion
  [[nodiscard]] std::optional<InertialError> error_at(const Window& window, ImuBuffer& imu);

  /// Beyond 0.15 m/s^2 or 0.01 rad/s, plus two standard deviations.
  [[nodiscard]] static bool is_step(const InertialError& error);

  void reset() { views_.reset(); }

 private:
  FeatureViews views_;
};

}  // namespace stillpoint
