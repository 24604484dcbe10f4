// SPDX-License-Identifier: BSD-3-Clause
/// Map of the static landmarks that the window last trusted, for relocalization after a loss.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/backend/start/camera_pose.h"
#include "core/backend/window/window.h"
#include "core/geometry/covariance.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

class TrustedMap {
 public:
  TrustedMap();

  /// Replaces the map by the usable landmarks of a window whose state is trusted; keeps its version of 0.5 to
  /// 1 s ago.
  void update(const Window& window);

  /// The newest version is based on a diverged estimate: returns to the earlier one.
  void discard_newest();

  void clear();
  [[nodiscard]] bool empty() const { return newest_.points.empty(); }

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
    std::vector<Point> points;  ///< sorted by id
  };

  Version newest_;
  Version candidate_;  ///< becomes `earlier_` once it is 0.5 s old
  Version earlier_;
  std::vector<PointObservation> observations_;  ///< buffer of `locate`
};

}  // namespace stillpoint
