// SPDX-License-Identifier: BSD-3-Clause
/// Limits by which the estimator decides what vision, depth and inertial data are worth (core/backend/health
/// and core/backend/vision). They are no keys of the configuration: one set serves all sensors that were
/// tried. Unless another origin is stated, they were tuned on rendered sequences with injected faults, see
/// reports/measured/faults.md.
#pragma once

#include <array>

namespace stillpoint {

/// A camera pose by features whose positions are known.
struct VisionLimits {
  double pose_inlier_px = 3.0;    ///< inliers of visual poses that inertial data is compared with; DepthScale
  double inlier_sigmas = 5.0;     ///< largest error of an inlier, in standard deviations of a bearing
  double min_depth_m = 0.05;      ///< nearer points are not used
  int min_inliers = 8;            ///< a frame is located by at least as many
  double min_inlier_ratio = 0.3;  ///< of the features, that locate a frame
  double min_inertial_inlier_ratio = 0.1;  ///< same, if inertial data agrees: the others may be on movers
  int few_inliers = 15;                    ///< fewer: degraded
  double weak_m = 0.1;                     ///< standard deviations of the pose above it: degraded
  double weak_rad = 0.05;                  ///< same
  double min_agreeing_ratio = 0.7;         ///< of the features, for a pose that may contradict inertial data
  double min_known_ratio = 0.25;           ///< same: features of known position among the tracked ones
  double min_witness_age_s = 0.2;          ///< of points that decide between such a pose and the prediction
  double witness_inlier_px = 1.0;          ///< see `support`
  double max_witness_loss = 3.0;           ///< of support by such a pose; as much gain confirms it
};

/// Errors of inertial data between three visual poses, see InertialError.
struct InertialErrorLimits {
  double accel = 3.0;             ///< severity 1 [m/s^2]
  double gyro = 0.1;              ///< same [rad/s]
  double sigmas = 4.0;            ///< same: added standard deviations
  double min_cosine = 0.7;        ///< between a change of the data and an error that it explains
  double min_change_ratio = 0.4;  ///< norm of that change to that of the error
};

/// See InertialCheck; the first two also of StepCheck.
struct InertialCheckLimits {
  double interval_s = 0.05;  ///< between two of the three poses, at least
  double history_s = 0.2;    ///< of the poses that are kept
  double agreeing_severity = 0.5;
  int agreeing_frames = 6;            ///< below that severity, until the data is used again
  double settling_s = 0.5;            ///< after vision was lost
  double max_doubt_s = 1.0;           ///< after a gap, without a contradiction
  double after_gap_s = 0.5;           ///< after missing samples the data may be inconsistent
  double after_change_s = 0.3;        ///< same after a change that explains an error
  double min_change_severity = 0.4;   ///< of that error
  double rest_statistic = 12.0;       ///< `zero_velocity_statistic` of a body at rest; its mean is 6 at rest
  double recognition_delay_s = 0.15;  ///< wrong data was wrong before it was recognized
};

/// See StepCheck. Errors, and changes of the data by which they are looked for.
struct StepCheckLimits {
  double accel = 1.5;         ///< [m/s^2]
  double gyro = 0.05;         ///< [rad/s]
  double accel_sigmas = 2.8;  ///< added to the errors, in standard deviations
  double gyro_sigmas = 2.0;   ///< same
};

/// Error of the bias of one sensor: e > base + sigmas * sigma.
struct BiasLimit {
  double base;
  double sigmas;
};

/// Errors in succession from which a step is recognized, whether vision must have been certain, and whether
/// the data must have changed by one of them.
struct BiasStepRule {
  BiasLimit limit;
  int errors;
  bool certain;
  bool explained;
};

/// See BiasCheck, Contradiction and BiasMonitor.
struct BiasCheckLimits {
  double interval_s = 0.24;         ///< between two of the three poses
  double min_interval_s = 0.12;     ///< between two checks
  double history_s = 0.9;           ///< of the views, and of the inertial samples that are kept for them
  double max_pause_s = 0.2;         ///< between measurements of the same step
  double min_cosine = 0.9;          ///< between the errors of one step
  double min_static_ratio = 0.125;  ///< of the tracked features, that must agree with a pose
  int min_agreeing = 20;            ///< same
  int certain_features = 40;        ///< agreeing ones with which vision is certain
  double certain_ratio = 0.33;      ///< same, of the tracked features
  BiasLimit gyro_agreement{.base = 0.003, .sigmas = 1.0};   ///< [rad/s]
  BiasLimit accel_agreement{.base = 0.15, .sigmas = 1.4};   ///< [m/s^2]
  BiasLimit gyro_difference{.base = 0.006, .sigmas = 8.0};  ///< [rad/s]
  BiasLimit accel_difference{.base = 0.05, .sigmas = 5.6};  ///< [m/s^2]
  std::array<BiasStepRule, 4> gyro_rules{
      {{.limit = {.base = 0.05, .sigmas = 16.0}, .errors = 1, .certain = true, .explained = true},
       {.limit = {.base = 0.006, .sigmas = 8.0}, .errors = 2, .certain = true, .explained = false},
       {.limit = {.base = 0.006, .sigmas = 4.0}, .errors = 4, .certain = false, .explained = false},
       {.limit = {.base = 0.0015, .sigmas = 2.0}, .errors = 6, .certain = true, .explained = false}}};
  std::array<BiasStepRule, 3> accel_rules{
      {{.limit = {.base = 0.2, .sigmas = 5.6}, .errors = 1, .certain = true, .explained = true},
       {.limit = {.base = 0.2, .sigmas = 4.2}, .errors = 2, .certain = false, .explained = true},
       {.limit = {.base = 0.05, .sigmas = 2.1}, .errors = 3, .certain = false, .explained = false}}};
  double step_delay_s = 0.6;              ///< age of a step when it is recognized, at most
  double max_difference_s = 1.0;          ///< errors that last longer are not those of a bias
  double min_agreement_s = 0.7;           ///< until the data is used again
  double contradiction_pause_s = 0.3;     ///< between checks that find the same contradiction
  double contradiction_duration_s = 1.0;  ///< after it, certain vision prevails
};

/// Convergence of the time offset, see OffsetSettling.
struct OffsetSettlingLimits {
  double interval_s = 0.5;
  double change_s = 0.0015;  ///< within the interval
  double max_s = 3.0;        ///< counts as settled after it in any case
};

/// Scale of the measured depth, see DepthScale and DepthMonitor.
struct DepthScaleLimits {
  int min_landmarks = 15;
  double agreeing = 0.02;  ///< relative difference from the median; half of the landmarks are within it
  double max_rejection_s = 10.0;
  /// Part of the accepted error below which a rejected scale agrees again: near the limit it would be
  /// accepted in single frames, which pull the landmarks to it.
  double agreeing_part = 0.5;
  /// Standard deviations of an estimated scale within the accepted error, from which on the depth is checked:
  /// with 3, depth that was 0.8 to 0.9 of the true one for 1.5 s was taken for that of another rig in 12 of
  /// 12 simulated runs (shipped_config_test), with 1 in none.
  double known_sigmas = 1.0;
};

/// Samples that are wrong by themselves, see SampleInspector, and the noise that replaces that of the sensor.
struct SampleLimits {
  double unreliable_gyro = 1.0;    ///< noise density of unusable samples [rad/s/sqrt(Hz)]
  double unreliable_accel = 20.0;  ///< same [m/s^2/sqrt(Hz)]
  int saturated_samples = 4;       ///< at the largest magnitude of the run, in succession
  int plateau_samples = 8;         ///< of one value, in succession
  double plateau_s = 0.03;         ///< their duration
};

/// Status and relocalization, see TrackingMonitor and TrustedMap.
struct TrackingLimits {
  double version_age_s = 0.5;  ///< of the version of the map to return to after a divergence
  int min_map_features = 12;   ///< of the map, in a frame that is located by it
  double min_map_inlier_ratio = 0.5;
  double gate_m = 0.5;       ///< largest distance between the poses of map and prediction
  double gate_rate_m = 2.0;  ///< same, per second since vision was lost
  double gate_rad = 0.5;
  double gate_rate_rad = 1.5;
  int visible_features = 20;  ///< in a frame from which a new segment can begin
  int min_relocalization_frames =
      10;  ///< such frames after a loss, at least: a camera of 4 Hz has four per second
  double max_dead_reckoning_sigma_m = 0.5;  ///< growth of the position's deviation without vision: lost
  double max_repetition_s = 0.12;  ///< without a new image, for constant velocity: three frames at 30 Hz
  int min_first_features = 8;      ///< with a measured depth, from which a window can start
};

/// Limits of a plausible state: Qin et al. 2018, Sec. VI-E (published code).
struct FailureLimits {
  double max_accel_bias = 2.5;  ///< [m/s^2]
  double max_gyro_bias = 1.0;   ///< [rad/s]
  double max_jump_m = 5.0;      ///< between successive frames
  int max_unusable_solves = 3;  ///< in succession
};

/// Innovations of the features, see `reprojection_nis`.
struct InnovationLimits {
  int min_landmarks = 8;
  double unexpected = 5.0;  ///< normalized innovation squared: the largest one on four rendered sequences is
                            ///< 4.6; that of a clock that jumped is 9 or more
};

struct MonitorConfig {
  VisionLimits vision;
  InertialErrorLimits inertial_error;
  InertialCheckLimits inertial;
  StepCheckLimits step;
  BiasCheckLimits bias;
  OffsetSettlingLimits offset;
  DepthScaleLimits depth_scale;
  SampleLimits samples;
  TrackingLimits tracking;
  FailureLimits failure;
  InnovationLimits innovation;
};

inline constexpr MonitorConfig kMonitor{};

}  // namespace stillpoint
