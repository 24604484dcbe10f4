// SPDX-License-Identifier: BSD-3-Clause
/// Map of the static landmarks that the window last trusted, by which a camera is located after a loss.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/backend/vision/camera_pose.h"
#include "core/backend/window/window.h"
#include "core/geometry/covariance.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

class TrustedMap {
 public:
  TrustedMap();

  /// Replaces the map by the usable landmarks of a window whose state is trusted; keeps its version of 0.5 to
  /// 1 s ago.
  /// @param covariance of the newest pose of the body, see UncertainPose
  void update(const Window& window, const Matrix6& covariance);

  /// The newest version is based on a diverged estimate: returns to the earlier one.
  void discard_newest();

  void clear();
  [[nodiscard]] bool empty() const { return newest_.points.empty(); }
  /// Stamp of the frame whose landmarks it has, and the pose of the body then, whose error they share; only
  /// if not empty.
  [[nodiscard]] Timestamp updated_at() const { return newest_.t; }
  [[nodiscard]] const UncertainPose& T_w_b() const { return newest_.T_w_b; }

  /// Camera pose by the features of a frame that are in the map (PnP), with its covariance.
  /// @param prediction    predicted T_w_c
  /// @param bearing_sigma standard deviation of a bearing
  /// @return nothing for fewer than twelve features of the map, or if fewer than half of them agree
  [[nodiscard]] std::optional<UncertainPose> locate(const TrackedFrame& frame, const Pose& prediction,
                                                    CameraPoseOptions options, double bearing_sigma);

 private:
  struct Point {
    std::int64_t id = 0;
    Eigen::Vector3d p_w = Eigen::Vector3d::Zero();
  };
  struct Version {
    Timestamp t;
    UncertainPose T_w_b;
    std::vector<Point> points;  ///< sorted by id
  };

  Version newest_;
  Version candidate_;  ///< becomes `earlier_` once it is 0.5 s old
  Version earlier_;
  std::vector<PointObservation> observations_;  ///< buffer of `locate`
};

}  // namespace stillpoint
