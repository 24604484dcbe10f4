// SPDX-License-Identifier: BSD-3-Clause
/// Batch estimation of the calibration from one or several recordings of unknown scenes, without a target.
///
/// The minimum over keyframe poses, landmarks, velocities, biases, gravity and the shared parameters of the
/// rig of
///
///   sum |r_pixel|^2 + sum |r_depth|^2 + sum |r_edge|^2 + sum |r_imu|^2 + sum |r_prior|^2
///
/// with the residuals of calibration_factors.h and ImuFactor, robust losses, and one prior per shared
/// parameter around its stated value. Each section of the recording has a world of its own, whose first pose
/// is fixed. Edges are used if depth images are not registered: those of depth images with the nearest ones
/// of the color images, within a distance that decreases to 4 px over the rounds. Without inertial data the
/// metric scale is that of the depth sensor: its scale is then not observed and stays as stated.
///
/// Rounds: solve; estimate the deviation of pixels, of inverse depths and of the inertial data from their
/// residuals, corrected for the number of estimated values; leave out observations beyond four deviations;
/// integrate the inertial samples again at the new biases and time offset. The first round uses fixed
/// deviations and Cauchy losses.
///
/// Each inertial sensor measures A (I + U) x + bias of a true value x, with the stated A (see ImuAxes). U is
/// upper triangular: three relative scales on its diagonal, three angles above it. The three angles below it
/// of one sensor are those of the body frame, which T_b_c contains; of both sensors they are taken as equal.
///
/// Standard deviations: with the Jacobian J of all weighted residuals r, x = (J^T J)^-1 e_p is the gain of
/// the parameter p. Residuals of a landmark l are correlated, as tracking errors last for many frames and
/// keyframes are close; those of different landmarks are taken as independent, as is all other data (o). The
/// variance is that of estimation with clusters (Liang and Zeger 1986), here with landmarks, and the
/// edges of a keyframe, as clusters l:
///
///   sigma_p^2 = sum_l (r_l^T J_l x)^2 + |J_o x|^2
///
/// which is the diagonal of (J^T J)^-1 if all residuals are independent. What is left are errors that
/// landmarks have in common: the two halves of the keyframes are estimated separately, too, and if their
/// estimates x_1 and x_2 differ by more than their deviations s_1 and s_2 allow, all deviations are
/// multiplied by
///
///   sqrt(mean_p (x_1p - x_2p)^2 / (s_1p^2 + s_2p^2))
///
/// over the observed parameters p, and the whole is solved again with data of such larger deviations against
/// the priors. What both halves have in common is added as a constant per parameter, see calibrate.cpp.
///
/// Time offset and readout time are observed only if the inertial data, if there is any, changes by more than
/// its noise: noise has derivatives at rest, too.
///
/// Values that are not observed, but for components of poses, get the stated ones, and the others are
/// estimated once more: with deviations as if the stated ones were true, but for axes of inertial sensors,
/// offset and displacement of the depth, which are off by their priors even in good rigs.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/calibration/calibration_recording.h"
#include "core/calibration/resting_noise.h"
#include "core/types/rig.h"
#include "core/types/trajectory.h"

namespace stillpoint {

/// Calibration of a rig, with what `Rig` lacks.
struct RigCalibration {
  Rig rig;                     ///< `depth_units_per_m` includes the scale of the depth
  Camera depth_camera;         ///< of depth images that are not registered, else that of the rig
  Pose T_c_d;                  ///< depth camera to color camera
  double depth_delay_s = 0.0;  ///< exposure of the depth image minus that of the color image
};

/// Which parameters are estimated.
struct CalibrationSwitches {
  bool focal = true;
  bool center = true;
  bool distortion = true;  ///< the first two coefficients of the model of the rig
  bool rolling_shutter = true;
  bool depth_scale = true;  ///< with inertial data only
  bool depth_offset = true;
  bool depth_intrinsics = true;  ///< of depth images that are not registered; of others the displacement
  bool depth_pose = true;        ///< of depth images that are not registered, and their delay
  bool extrinsics = true;        ///< with inertial data only, as the next
  bool time_offset = true;
  bool imu_intrinsics = true;  ///< scale and misalignment of gyroscope and accelerometer
};

/// Standard deviations of stated values: by what rigs are off whose calibration is a drawing, a data sheet or
/// that of another device of the same kind.
struct CalibrationPriors {
  double focal = 0.03;         ///< relative
  double focal_ratio = 0.005;  ///< of fx / fy
  double center_px = 10.0;
  double distortion = 0.1;  ///< of each coefficient
  double rolling_shutter_s = 0.02;
  double depth_scale = 0.15;
  double depth_offset = 0.005;  ///< [1/m]: 0.2 px of disparity where focal length times baseline is 40 px m
  double depth_focal = 0.05;    ///< relative
  double depth_center_px = 10.0;
  double rotation_rad = 0.035;  ///< 2 deg; of T_b_c and T_c_d
  double lever_m = 0.03;
  double time_offset_s = 0.02;
  double imu_scale = 0.01;       ///< relative
  double imu_axes_rad = 0.0087;  ///< 0.5 deg; of each angle of misalignment
  double depth_delay_s = 0.02;
  double truth_rotation_rad = 0.5;
  double truth_position_m = 1.0;
  double truth_delay_s = 0.1;
};

struct CalibrationProgress {
  int step = 0;       ///< rounds so far
  int steps = 1;      ///< rounds in all
  int iteration = 0;  ///< of this round
  double cost = 0.0;  ///< half the sum of the squared residuals
};

struct CalibrationOptions {
  CalibrationSwitches estimate;
  CalibrationPriors priors;
  bool hold_out = true;  ///< estimate the halves, too
  /// Called after each iteration; false: stop with the present values. May be empty.
  std::function<bool(const CalibrationProgress&)> on_iteration;
};

/// Conclusion about one parameter.
enum class ParameterOutcome { kNotObserved, kAgrees, kDiffers };

/// One number of the calibration.
struct ParameterEstimate {
  std::string name;  ///< as in rig.toml where it has a key, e.g. "fx"; rotations: "T_b_c rotation x"
  std::string unit;
  double value = 0.0;
  double sigma = 0.0;   ///< standard deviation; that of the prior if it is not observed
  double stated = 0.0;  ///< in the rig that the estimation started from
  double prior_sigma = 0.0;
  ParameterOutcome outcome = ParameterOutcome::kNotObserved;

  [[nodiscard]] double difference() const { return value - stated; }
};

/// Reprojection error of one observation.
struct ImageResidual {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();     ///< where it was seen [px]
  Eigen::Vector2d error_px = Eigen::Vector2d::Zero();  ///< predicted minus seen
};

/// RMS of the residuals of one half of the keyframes, with the calibration that was estimated from the other.
struct HeldOutResiduals {
  double pixel_before_px = 0.0;  ///< with the stated calibration
  double pixel_after_px = 0.0;
  double depth_before = 0.0;  ///< inverse depth [1/m]; zero without depth
  double depth_after = 0.0;
  std::vector<ImageResidual> before, after;  ///< of all inliers
};

/// Biases of the inertial sensors over the keyframes, and the standard deviations of their changes.
struct InertialBiases {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();  ///< mean [rad/s]
  Eigen::Vector3d gyro_spread = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< mean [m/s^2]
  Eigen::Vector3d accel_spread = Eigen::Vector3d::Zero();
};

struct CalibrationResult {
  RigCalibration calibration;
  std::vector<ParameterEstimate> parameters;  ///< those that were to be estimated
  std::size_t keyframes = 0, landmarks = 0, observations = 0, depths = 0, inertial_factors = 0;
  double pixel_sigma_px = 0.0;
  double inverse_depth_sigma = 0.0;                   ///< [1/m]
  ImuNoiseFactors imu_noise;                          ///< by the residuals, at least 1
  std::optional<InertialBiases> biases;               ///< with inertial data
  std::optional<RestingNoise> rest;                   ///< of the inertial sensors, where they rest
  std::size_t truth_poses = 0;                        ///< keyframes at which the ground truth is known
  double truth_sigma_m = 0.0, truth_sigma_rad = 0.0;  ///< of the ground truth, by the residuals
  double deviation_factor = 1.0;  ///< by which the halves differ more than expected, at least 1
  HeldOutResiduals held_out;
  bool has_held_out = false;
  bool interrupted = false;  ///< by `on_iteration`
  bool usable = true;        ///< false: the solver failed, or the deviations could not be computed
};

/// A ground truth of a frame f that is fixed to the body, in a world and by a clock of its own.
struct CalibrationTruth {
  Trajectory trajectory;  ///< empty: none
  Pose T_f_b;             ///< initial value, whose rotation is right to 30 degrees
  double delay_s =
      0.0;  ///< initial value, right to a tenth of a second: stamp of the truth minus that of the image
};

/// @param stated calibration from which the sections were computed
/// @param sections with at least ten keyframes in all
/// @param imu ascending; empty: without inertial data
/// @param gravity norm [m/s^2]
struct CalibrationInput {
  RigCalibration stated;
  std::vector<CalibrationSection> sections;
  std::vector<ImuSample> imu;
  double gravity = 9.81;
  /// Whether the depth images have the pixels of the color camera; else those of `depth_camera`.
  bool depth_is_registered = true;
  /// Draws the poses to it where it is known, and adds its delay and T_f_b to the parameters.
  CalibrationTruth truth;
};

/// What tells that recordings are not of one device: the first entry of their rig files with other values, or
/// a sensor that only one has. Keyframes are not compared.
/// @return such as "[camera] fx is 500 and 510"; empty: nothing
[[nodiscard]] std::string stated_difference(const CalibrationInput& a, const CalibrationInput& b);

/// Adds another recording of the same device, to which only the calibration is common. Its times are moved
/// behind those of the recordings before it; `halves` of all are then, as a rule, different recordings.
/// @param next its ground truth is not used
/// @throws InputError if one has no keyframes, or with a `stated_difference`
void append_recording(CalibrationInput& all, CalibrationInput next);

/// @throws InputError if fewer than ten keyframes or 50 landmarks remain, without both depth and IMU, or if
/// the ground truth is known at fewer than ten keyframes
[[nodiscard]] CalibrationResult calibrate(const CalibrationInput& input, const CalibrationOptions& options);

}  // namespace stillpoint
