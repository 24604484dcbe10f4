// SPDX-License-Identifier: BSD-3-Clause
/// State of the odometry after a frame, and the reason for it.
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
#pragma once

#include <cstddef>
#include <string_view>

namespace stillpoint {

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

enum class StatusReason {
  kNone,
  kNoInertialStart,  ///< gravity and velocity are not initialized (again)
  kFewFeatures,      ///< vision: too few static features agree with the pose
  kWeakGeometry,     ///< vision: the features do not determine all six degrees of freedom
  kImuGap,           ///< samples are missing
  kImuSaturated,     ///< samples are at the limit of the sensor
  kImuInconsistent,  ///< samples contradict vision
  kUncertain,        ///< dead reckoning for too long
  kDiverged,         ///< implausible state
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

}  // namespace stillpoint
