// SPDX-License-Identifier: BSD-3-Clause
/// Three checks by the error of inertial data between visual poses (`inertial_error`): of data that
/// contradicts the poses of the window, of data that becomes wrong from one frame to the next, and of steps
/// of the biases.
#pragma once

#include <optional>
#include <vector>

#include "core/backend/health/inertial_error.h"
#include "core/backend/vision/feature_views.h"
#include "core/config/monitor_config.h"
#include "core/imu/imu_buffer.h"
#include "core/types/nav_state.h"

namespace stillpoint {

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
  /// Samples were missing at `t` on the IMU clock.
  void missing(Timestamp t) { missing_at_ = t; }
  /// That clock may have jumped before `t`: the data counts as inconsistent until it agrees with vision, or
  /// for 1 s if nothing contradicts it by then.
  void doubt(Timestamp t);
  /// Ends a doubt that began 1 s before `t`.
  void end_old_doubt(Timestamp t);
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
  std::optional<Timestamp> doubted_since_;     ///< inconsistent for no other reason than `doubt`
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
