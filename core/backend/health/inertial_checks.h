// SPDX-License-Identifier: BSD-3-Clause
/// Inertial data compared with vision over two successive intervals between three visual poses: the error
/// that explains the difference (`inertial_error`), and three checks by it, of data that contradicts the
/// poses of the window, of data that becomes wrong from one frame to the next, and of steps of the biases.
#pragma once

#include <optional>
#include <vector>

#include "core/backend/vision/feature_views.h"
#include "core/config/monitor_config.h"
#include "core/imu/imu_buffer.h"
#include "core/types/nav_state.h"

namespace stillpoint {

struct InertialError {
  Eigen::Vector3d accel_w;   ///< a: constant error of the accelerometer that explains the difference [m/s^2]
  Eigen::Vector3d gyro_b;    ///< w: same for the gyroscope, in the last body frame [rad/s]
  double accel_sigma = 0.0;  ///< of a along its least certain direction, due to the visual poses
  double gyro_sigma = 0.0;   ///< of w, likewise
  Eigen::Vector3d accel_change_w;  ///< mean specific force of the second interval less that of the first
  Eigen::Vector3d gyro_change_b;   ///< same for the angular rate

  /// Ratios of the errors to their limits: |a| to 3 m/s^2, |w| to 0.1 rad/s, each plus four standard
  /// deviations.
  [[nodiscard]] double accel_severity() const;
  [[nodiscard]] double gyro_severity() const;

  /// Whether the data of a sensor changed as it does when it becomes wrong, during a shock or after a step of
  /// a bias. With the changes f of the specific force and r of the angular rate:
  ///
  ///   a.f >= 0.7 |a| |f|,  |f| >= 0.4 |a|    and the same for w and r
  ///
  /// A person who starts to move in front of the camera contradicts sound inertial data, too, but does not
  /// change it. The small error of a sound sensor is sometimes explained by chance.
  [[nodiscard]] bool accel_is_explained() const;
  [[nodiscard]] bool gyro_is_explained() const;
};

/// Three poses in temporal order.
struct VisualPoses {
  using Covariance = Eigen::Matrix<double, 18, 18>;

  const VisualPose& A;
  const VisualPose& B;
  const VisualPose& C;
  Covariance covariance;  ///< of (dp_A, dtheta_A, dp_B, dtheta_B, dp_C, dtheta_C), see UncertainPose
};

/// Poses with independent errors: each was found by known positions of its features.
[[nodiscard]] VisualPoses independent_poses(const VisualPose& A, const VisualPose& B, const VisualPose& C);

/// Poses of which A is exact, and B and C were computed from the pose before with independent errors (rho,
/// phi) of the motion:
///
///   dp_B = R_A rho_1,                                   dtheta_B = phi_1,
///   dp_C = R_A rho_1 - R_B [p_BC]x phi_1 + R_B rho_2,   dtheta_C = R_BC^T phi_1 + phi_2.
[[nodiscard]] VisualPoses chained_poses(const VisualPose& A, const VisualPose& B, const VisualPose& C);

/// Compares the preintegrated motion between three visual poses A, B, C with these poses; independent of the
/// estimated velocity. With the intervals T1, T2, gravity g, and the preintegrated dp1, dv1 (A to B) and dp2
/// (B to C), the velocity at B follows from either interval:
///
///   v_1 = (p_B - p_A) / T1 + 1/2 g T1 + R_A (dv1 - dp1 / T1)
///   v_2 = (p_C - p_B) / T2 - 1/2 g T2 - R_B dp2 / T2
///
/// A constant error a of the accelerometer gives v_1 - v_2 = a (T1 + T2) / 2; an error w of the gyroscope
/// turns R_C by w (T1 + T2). With T = T1 + T2, f1 = dv1 - dp1 / T1 and f2 = dp2 / T2, errors of the poses
/// give
///
///   a: 2/T (-dp_A / T1 - R_A [f1]x dtheta_A + (1/T1 + 1/T2) dp_B - R_B [f2]x dtheta_B - dp_C / T2)
///   w: 1/T ((dR1 dR2)^T dtheta_A - dtheta_C),
///
/// where f1 and f2 are about -g T1 / 2 and -g T2 / 2: an error of the attitude turns gravity.
/// @param state biases
/// @return nullopt if samples are missing
[[nodiscard]] std::optional<InertialError> inertial_error(const VisualPoses& poses, const NavState& state,
                                                          const Eigen::Vector3d& gravity_w, ImuBuffer& imu);

/// Compares the inertial data between three visual poses, each at least 50 ms apart, with these poses, see
/// `inertial_error`. The data of a sensor is inconsistent if its severity is above 1 and its change explained
/// an error in the last 0.3 s, or samples were missing in the last 0.5 s; and consistent again after six
/// frames with half of that severity of both sensors. Without such a reason vision is wrong, e.g. because it
/// follows a person in front of the camera. That the data of the other sensor changed is a reason only if the
/// pose is confirmed by old points: a clock that jumps changes both, but gyroscopes also vibrate.
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
  /// Samples were missing at `t` on the IMU clock, or its stamps jumped: those that follow count as
  /// inconsistent until they agree with vision.
  void missing(Timestamp t) {
    missing_at_ = t;
    contradict();
  }
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
  /// Whether a sensor that errs by `severity` is wrong. @param has_changed in the last 0.3 s
  [[nodiscard]] bool is_wrong(double severity, bool has_changed, Timestamp now) const;

  std::vector<VisualPose> poses_;  ///< of the last 0.2 s
  std::optional<Timestamp> resume_at_;
  std::optional<Timestamp> missing_at_;
  std::optional<Timestamp> accel_changed_at_;  ///< last change that explained an error
  std::optional<Timestamp> gyro_changed_at_;   ///< same
  bool held_ = false;
  bool consistent_ = true;
  int agreeing_frames_ = 0;
};

/// Recognizes wrong data before it is used to label moving features. The data of about 0.13 s is wrong if it
/// errs by 1.5 m/s^2 plus 2.8 standard deviations or 0.05 rad/s plus two of them, and its change explains the
/// error, see `InertialError`.
class StepCheck {
 public:
  /// @param focal_px of the camera, > 0
  explicit StepCheck(double focal_px)
      : views_({.focal_px = focal_px, .history_s = kMonitor.inertial.history_s}) {}

  /// Processes the newest frame of an inertial window at its predicted pose. Landmarks labeled dynamic so far
  /// are left out. Visual poses are computed only if the data changed by 1.5 m/s^2 or 0.05 rad/s.
  /// @return whether its inertial data is wrong
  [[nodiscard]] bool is_wrong(const Window& window, ImuBuffer& imu);

  void reset() { views_.reset(); }

 private:
  [[nodiscard]] bool data_changed(std::size_t first, std::size_t middle) const;

  FeatureViews views_;
};

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
///       1       |e| > 0.05 + 16 s, explained           |e| > 0.2 + 5.6 s, explained, vision is certain
///       2       |e| > 0.006 + 8 s                      |e| > 0.2 + 4.2 s, one is explained
///       3                                              |e| > 0.05 + 2.1 s
///       4       |e| > 0.006 + 4 s, vision certain or not
///       6       |e| > 0.0015 + 2 s
///
/// An explained error is one by which the data changed, see InertialError. An image that jumps gives two
/// errors of one direction, and then two of the opposite one. Each pose is determined by 20 features, an
/// eighth of all that are tracked; vision is certain with 40, a third of all, else people who cover the image
/// look like a step. Features that were labeled static at the earlier pose are used: a step of the
/// accelerometer makes them appear to move, and they lose their label. Errors below 0.003 rad/s + s
/// and 0.15 m/s^2 + 1.4 s are agreement if vision is certain.
class BiasCheck {
 public:
  /// kDoubtful: they differ, but vision is not certain, so that it may be wrong itself
  enum class Result { kUnknown, kAgrees, kDoubtful, kDiffers, kStep };

  /// @param focal_px of the camera, > 0
  explicit BiasCheck(double focal_px)
      : views_({.focal_px = focal_px,
                .min_interval_s = kMonitor.bias.min_interval_s,
                .history_s = kMonitor.bias.history_s,
                .uses_relabeled = true,
                .min_static_ratio = kMonitor.bias.min_static_ratio,
                .min_agreeing = kMonitor.bias.min_agreeing}) {}

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
