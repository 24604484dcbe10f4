// SPDX-License-Identifier: BSD-3-Clause
/// Detection of inertial data that contradicts vision.
#pragma once

#include <optional>
#include <vector>

#include "core/imu/imu_buffer.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// A pose determined by vision alone.
struct VisualPose {
  Timestamp t;  ///< on the IMU clock
  Pose T_w_b;
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
};

/// Compares the preintegrated motion between three visual poses A, B, C, each at least 50 ms apart, with
/// these poses; independent of the estimated velocity. With the intervals T1, T2, gravity g, and the
/// preintegrated dp1, dv1 (A to B) and dp2 (B to C), the velocity at B follows from either interval:
///
///   v_1 = (p_B - p_A) / T1 + 1/2 g T1 + R_A (dv1 - dp1 / T1)
///   v_2 = (p_C - p_B) / T2 - 1/2 g T2 - R_B dp2 / T2
///
/// A constant error a of the accelerometer gives v_1 - v_2 = a (T1 + T2) / 2; an error w of the gyroscope
/// turns R_C by w (T1 + T2). The data is inconsistent if |a| > 3 m/s^2 or |w| > 0.1 rad/s, each plus four
/// standard deviations due to the visual poses, and consistent again after six frames with half of that.
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
  /// After a change of the world frame. The data counts as consistent.
  void reset();

  [[nodiscard]] bool is_consistent() const { return consistent_; }

 private:
  [[nodiscard]] std::optional<std::size_t> pose_before(Timestamp t) const;
  [[nodiscard]] std::optional<double> severity(const VisualPose& pose, const NavState& state,
                                               const Eigen::Vector3d& gravity_w, ImuBuffer& imu);

  std::vector<VisualPose> poses_;         ///< of the last 0.2 s
  std::vector<ImuSample> first_samples_;  ///< buffers of `severity`
  std::vector<ImuSample> second_samples_;
  std::optional<Timestamp> resume_at_;
  bool consistent_ = true;
  int agreeing_frames_ = 0;
};

}  // namespace stillpoint
