// SPDX-License-Identifier: BSD-3-Clause
/// Output of the estimator after each frame: state, status with its reason, and statistics.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/module_timings.h"
#include "core/types/nav_state.h"
#include "core/types/rig.h"

namespace stillpoint {

/// State of the odometry after a frame.
///
/// V: vision locates the camera. I: inertial data is usable. M: a pose from the map of trusted landmarks.
///
///                        V, I                    not V, I
///   initializing ---------------> tracking <----------------> dead_reckoning
///        ^                        |   ^                            |
///        |           V weak,      |   | V, I                       | diverged, or too uncertain
///        |           or not I     v   |                            v
///        |                       degraded ------ not V ---------> lost
///        |                          ^         (and not I)          |
///        | no M: new segment        | V                       M    |
///        +-----------------+        +------ relocated <------------+
///                          |                                       |
///                          +---------------------------------------+
///
/// Without an IMU there is no dead reckoning, but a repeated image is bridged for 0.12 s: `degraded`.
/// `relocated` lasts one frame. A diverged estimate is `lost`.
///
/// | status         | pose                | trajectory, coverage     |
/// |----------------|---------------------|--------------------------|
/// | initializing   | invalid             | no                       |
/// | tracking       | valid               | yes                      |
/// | degraded       | valid, less certain | yes                      |
/// | dead_reckoning | inertial only       | separate, does not count |
/// | lost           | invalid             | no                       |
/// | relocated      | valid               | yes                      |
enum class OdometryStatus { kInitializing, kTracking, kDegraded, kDeadReckoning, kLost, kRelocated };

/// Names used in output files.
[[nodiscard]] constexpr std::string_view status_name(OdometryStatus status) {
  constexpr std::string_view kNames[] = {"initializing",   "tracking", "degraded",
                                         "dead_reckoning", "lost",     "relocated"};
  return kNames[static_cast<std::size_t>(status)];
}

/// Whether a pose is valid by vision: it is written to the trajectory and counts for coverage.
[[nodiscard]] constexpr bool is_located(OdometryStatus status) {
  using enum OdometryStatus;
  return status == kTracking || status == kDegraded || status == kRelocated;
}

/// The reason for a status.
enum class StatusReason {
  kNone,
  kNoInertialStart,  ///< gravity and velocity are not initialized (again)
  kFewFeatures,      ///< vision: too few static features agree with the pose
  kWeakGeometry,     ///< vision: the features do not determine all six degrees of freedom
  kImuGap,           ///< samples are missing
  kImuSaturated,     ///< samples are at the limit of the sensor
  kImuInconsistent,  ///< samples contradict vision
  kUncertain,        ///< dead reckoning for too long
  kDiverged,         ///< implausible state, or the static world appears to move
  kSolveFailed,      ///< the solver failed repeatedly
  kMapMatched,       ///< located by the map of trusted landmarks
  kRepeatedImage,    ///< no new image: constant velocity, without an IMU
};

/// Names used in output files.
[[nodiscard]] constexpr std::string_view reason_name(StatusReason reason) {
  constexpr std::string_view kNames[] = {
      "",         "no_inertial_start", "few_features",     "weak_geometry",
      "imu_gap",  "imu_saturated",     "imu_inconsistent", "uncertain",
      "diverged", "solve_failed",      "map_matched",      "repeated_image"};
  return kNames[static_cast<std::size_t>(reason)];
}

struct OdometryCounters {
  int tracked_features = 0;  ///< received from the tracker
  int window_landmarks = 0;  ///< included in the solve
  int depth_landmarks = 0;   ///< of those, with measured depth
  int dynamic_features = 0;  ///< excluded as dynamic
  int solver_iterations = 0;
  bool keyframe = false;
  bool reset = false;  ///< a failure was detected in this frame; the estimator reinitializes
};

/// Normalized innovation squared of a frame at its predicted pose, see
/// core/backend/vision/vision_assessment.h: 1 in the mean for true covariances (inertial: 0.6 to 1.1, see
/// InertialNoise). Absent without a covariance or reliable inertial data.
struct Innovations {
  std::optional<double> reprojection;
  std::optional<double> inertial;  ///< also absent at rest, or if vision does not determine the pose
};

/// Estimated calibration that is at a bound of the configuration: it does not fit the data, or the calibrated
/// value is far off.
struct CalibrationAtBound {
  bool time_offset = false;
  bool extrinsics = false;
  bool depth_scale = false;
};

/// Hashes of the modules' state after a frame, see core/pipeline/stages/replication.h.
struct StateHashes {
  std::uint64_t tracking = 0;      ///< features
  std::uint64_t dynamic = 0;       ///< labels
  std::uint64_t optimization = 0;  ///< state
};

/// `state` is valid only if `is_located(status)`; while dead reckoning it is propagated by inertial data.
struct OdometryUpdate {
  std::int64_t frame_id = 0;
  NavState state;
  Pose T_w_c;  ///< camera pose, by the extrinsics estimated at this frame
  /// Pose of the odometry's world in the map, by the loops that are known at this frame (`loop.lag_frames`);
  /// the identity without loop closure. T_m_w * T_w_c is the corrected pose.
  Pose T_m_w;
  /// Whether T_m_w is known. With loop closure, later segments and runs with a loaded map are located in the
  /// map by the places that they share with it; until then T_m_w is the identity.
  bool in_map = true;
  OdometryStatus status = OdometryStatus::kInitializing;
  StatusReason reason = StatusReason::kNone;
  int segment = 0;        ///< number of the world frame; a new one begins after a loss without relocation
  bool inertial = false;  ///< whether inertial samples propagate `state`; else constant velocity does
  double time_offset_s = 0.0;  ///< current estimate
  double depth_scale = 1.0;    ///< ratio of measured to true depth; current estimate
  /// Current estimate of the lens correction (f, k1, cx, cy), see core/backend/factors/reprojection_rows.h.
  Eigen::Vector4d lens = Eigen::Vector4d::Zero();
  CalibrationAtBound at_bound;
  AgreesWithRig agrees_with_rig;
  RigStep rig_step;                                 ///< of the last solve with a covariance
  std::optional<AlignedRotation> aligned_rotation;  ///< once rotations were aligned
  ImuNoiseFactors imu_noise;                        ///< current estimate
  /// Rotates the world such that gravity points along -z, by the current estimate of gravity; the identity if
  /// gravity is not estimated (`backend.gravity`) or not yet known.
  Eigen::Quaterniond q_level_w = Eigen::Quaterniond::Identity();
  /// Of `state`, as of the last solve; absent unless `backend.covariance` is on and the frame was solved.
  std::optional<StateCovariance> covariance;
  Innovations nis;
  OdometryCounters counters;
  StateHashes hashes;
  ModuleTimings timings;
};

}  // namespace stillpoint
