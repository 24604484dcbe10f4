// SPDX-License-Identifier: BSD-3-Clause
/// Detection of inertial data that contradicts vision.
#pragma once

#include <optional>
#include <vector>

#include "core/backend/health/inertial_error.h"

namespace stillpoint {

/// Compares the inertial data between three visual poses, each at least 50 ms apart, with these poses, see
/// `inertial_error`. The data is inconsistent if the severity is above 1 and the change of the data
/// explained an error in the last 0.3 s, or samples were missing in the last 0.5 s; and consistent again
/// after six frames with half of that severity. Without such a reason vision is wrong, e.g. because it
/// follows a person in front of the camera.
class InertialCheck {
 public:
  /// @param pose later than the previous one
  /// @param state biases of the newest state
  /// @return whether the inertial data is consistent; unchanged if samples or earlier poses are missing
  bool update(const VisualPose& pose, const NavState& state, const Eigen::Vector3d& gravity_w,
              ImuBuffer& imu);

  /// Vision did not locate the frame at `t` on the IMU clock: the poses before it and those of the next 0.5
  /// s, in which the window settles, are not compared.
  void interrupt(Timestamp t);
  /// Samples were missing at `t` on the IMU clock.
  void missing(Timestamp t) { missing_at_ = t; }
  /// The data is wrong for another reason: it counts as inconsistent until it agrees with vision.
  void contradict();
  /// Whether the data stays inconsistent although it agrees.
  void hold(bool held) { held_ = held; }
  /// After a change of the world frame. The data counts as consistent.
  void reset();

  [[nodiscard]] bool is_consistent() const { return consistent_; }

 private:
  [[nodiscard]] std::optional<std::size_t> pose_before(Timestamp t) const;
  [[nodiscard]] std::optional<InertialError> error_at(const VisualPose& pose, const NavState& state,
                                                      const Eigen::Vector3d& gravity_w, ImuBuffer& imu);

  std::vector<VisualPose> poses_;  ///< of the last 0.2 s
  std::optional<Timestamp> resume_at_;
  std::optional<Timestamp> missing_at_;
  std::optional<Timestamp> changed_at_;
  bool held_ = false;
  bool consistent_ = true;
  int agreeing_frames_ = 0;
};

}  // namespace stillpoint
