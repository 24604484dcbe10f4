// SPDX-License-Identifier: BSD-3-Clause
/// Recognition of a window that takes the static world for a moving object.
#pragma once

#include <optional>
#include <vector>

#include "core/backend/window/window.h"
#include "core/geometry/pose_from_points.h"

namespace stillpoint {

/// A camera that begins to move behind a person who covers its view is estimated to be at rest. Inertial data
/// cannot tell rest from a constant velocity: after the person has left, features of the scene do not move as
/// predicted and are labeled dynamic, one after the other, while the window follows its wrong velocity.
///
/// Compares the features of the newest frame, static or dynamic, with their measured positions in a frame 0.2
/// s before. The world appears to move if less than 15 % of them agree with the motion of the window, at
/// least 40 % with a common one, and the middle half of those extends over 0.6 m in some direction, which
/// that on a person so close to the camera does not.
class MovingWorld {
 public:
  /// @param focal_px of the camera, > 0
  explicit MovingWorld(double focal_px);

  /// Processes the optimized window. Costs a pass over the landmarks unless most of them are dynamic.
  /// @return whether the world has appeared to move for 1.5 s, in this frame as well
  [[nodiscard]] bool update(const Window& window);

  void reset() { since_.reset(); }

 private:
  /// @return nullopt if it is not known
  [[nodiscard]] std::optional<bool> appears_to_move(const Window& window);
  /// Interquartile range of the points that agree with a camera pose, along the axis where it is largest [m].
  [[nodiscard]] double extent(const Pose& T_w_c);

  double inlier_;  ///< largest error of the bearing
  std::optional<Timestamp> since_;
  std::vector<PointObservation> points_;  ///< in the camera frame of the earlier frame
  std::vector<double> coordinates_;       ///< buffer of `extent`
};

}  // namespace stillpoint
