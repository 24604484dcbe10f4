// SPDX-License-Identifier: BSD-3-Clause
/// Detection of a depth sensor whose scale has changed, and rejection of its depth.
#pragma once

#include <optional>
#include <vector>

#include "core/backend/window/window.h"
#include "core/config/monitor_config.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// Compares the depths d_k measured in the newest frame with the depths z_k of the same static landmarks at
/// its predicted pose, as known from earlier frames. The scale is the median of d_k / (s z_k) with the
/// estimated depth scale s of the window, if at least 15 landmarks are compared and half of the ratios are
/// within 2 % of it. If inertial data predicts the pose, landmarks that are observed more than 3 px from
/// their predicted position are left out: a person who stays in front of a moving camera is nearer than
/// predicted by the same factor everywhere.
class DepthScale {
 public:
  /// @param focal_px of the camera, > 0
  explicit DepthScale(double focal_px) : inlier_(kMonitor.vision.pose_inlier_px / focal_px) {}

  /// @return nullopt without a common scale
  [[nodiscard]] std::optional<double> of_newest(const Window& window);

 private:
  double inlier_;               ///< largest error of the bearing
  std::vector<double> ratios_;  ///< buffer of `of_newest`
};

/// Rejects measured depth whose scale differs from that of known landmarks, for at most 10 s: if the
/// contradiction persists, the landmarks are wrong. A scale that agreed for 1 s and differs from one frame to
/// the next is that of a sensor which has changed, whatever its true one is.
class DepthMonitor {
 public:
  /// @param max_error largest accepted error of the scale; 0 = no check
  /// @param focal_px of the camera, > 0
  DepthMonitor(double max_error, double focal_px) : max_error_(max_error), scale_(focal_px) {}

  /// Removes the depths measured in the newest frame if their scale contradicts the landmarks.
  /// @param covariance of the newest state, if it is known: an estimated scale must be certain, unless the
  ///   measured one jumps. While the scale of the rig is compared with the data, the comparison needs the
  ///   depth until it is certain.
  void update(const std::optional<StateCovariance>& covariance, Window& window);

  /// After a restart with another depth scale.
  void reset() {
    rejected_since_.reset();
    agrees_since_.reset();
  }

 private:
  [[nodiscard]] bool knows_scale(const std::optional<StateCovariance>& covariance,
                                 const Window& window) const;
  [[nodiscard]] bool has_jumped(double error, Timestamp t);

  double max_error_;
  DepthScale scale_;
  std::optional<Timestamp> agrees_since_;
  std::optional<Timestamp> rejected_since_;
  bool rejects_jump_ = false;  ///< since `rejected_since_`
};

}  // namespace stillpoint
