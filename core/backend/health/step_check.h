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

}  // namespace stillpoint
