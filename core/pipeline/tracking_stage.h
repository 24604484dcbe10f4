// SPDX-License-Identifier: BSD-3-Clause
/// The tracking thread's share of a picture. Paper Sec. II, III-A, III-B.
#pragma once

#include <optional>

#include "core/frontend/feature_tracker.h"
#include "core/pipeline/feedback.h"
#include "core/pipeline/odometry_config.h"

namespace stillpoint {

/// Predicts where features went, and follows them. Knows nothing of threads: what comes from the optimisation
/// comes as an argument.
class TrackingStage {
 public:
  TrackingStage(const OdometryConfig& config, const Rig& rig);

  /// Samples in order of time; those up to a picture's exposure come before the picture.
  void add_imu(const ImuSample& sample) { imu_.add(sample); }

  /// @param full  whether the picture enters the window: lost features are replaced
  /// @param feedback what the optimisation said last
  /// @param memory for the result: a frame that nobody needs any more
  [[nodiscard]] TrackedFrame process(const Frame& frame, bool full, const Feedback& feedback,
                                     TrackedFrame memory = {});

 private:
  bool predicts_;
  FeatureTracker tracker_;
  ImuBuffer imu_;
  std::optional<Timestamp> last_frame_;
};

}  // namespace stillpoint
