// SPDX-License-Identifier: BSD-3-Clause
/// The state that the estimator refines: frames of the sliding window, landmarks, calibration and the prior.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/backend/factors/exposure_shift.h"
#include "core/backend/factors/linear_prior.h"
#include "core/base/vector_pool.h"
#include "core/config/backend_config.h"
#include "core/imu/preintegration.h"
#include "core/types/nav_state.h"
#include "core/types/rig.h"

namespace stillpoint {

/// Observation of one landmark in one frame of the window.
struct Observation {
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();   ///< normalized image plane, with the lens correction
  Eigen::Vector2d seen = Eigen::Vector2d::Zero();      ///< bearing by the camera of the rig
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< of the bearing [1/s]
  double depth = 0.0;                                  ///< measured [m]; 0 = not measured or out of range
  double readout_offset_s = 0.0;  ///< readout time of its row minus that of the middle row
  double information = 1.0;       ///< fraction of its information that is not in the prior, > 0
};

/// Origin of the initial depth of a landmark.
enum class DepthSource { kNone, kMeasured, kTriangulated };

/// A 3D point, parameterized by its inverse depth along the bearing in its first observing frame (host).
struct Landmark {
  std::int64_t id = 0;
  int host = 0;                           ///< index of the first observing frame
  std::vector<Observation> observations;  ///< one for each frame from the host on, without gaps
  double inverse_depth = 0.0;             ///< [1/m], in the host; 0 = unknown
  DepthSource source = DepthSource::kNone;
  bool dynamic = false;  ///< tracked, but excluded from the estimate

  [[nodiscard]] int last() const { return host + static_cast<int>(observations.size()) - 1; }
  [[nodiscard]] bool observed_in(int frame) const { return frame >= host && frame <= last(); }
  [[nodiscard]] const Observation& observation_in(int frame) const {
    return observations[static_cast<std::size_t>(frame - host)];
  }
};

/// One frame of the window. The state is defined at IMU time `state.t + time_offset_s`; with
/// `TimeOffsetModel::kInertial` at the exposure, and only the preintegrations end at that time.
struct WindowFrame {
  std::int64_t id = 0;
  NavState state;
  double time_offset_s = 0.0;                         ///< estimated offset when the frame was added
  Eigen::Vector3d gyro_b = Eigen::Vector3d::Zero();   ///< angular rate at the exposure, bias included [rad/s]
  Eigen::Vector3d accel_b = Eigen::Vector3d::Zero();  ///< same: specific force [m/s^2]
  std::optional<Preintegration> from_previous;        ///< absent in the first frame and without an IMU
  bool imu_is_reliable = true;  ///< false: `from_previous` has the noise of missing or wrong samples
};

struct Window {
  std::vector<WindowFrame> frames;  ///< oldest first
  std::vector<Landmark> landmarks;  ///< sorted by id
  Pose T_b_c;
  double time_offset_s = 0.0;
  TimeOffsetModel time_offset_model = TimeOffsetModel::kBearing;
  double depth_scale = 1.0;                        ///< ratio of measured to true depth
  Eigen::Vector4d lens = Eigen::Vector4d::Zero();  ///< correction of the camera, see reprojection_rows.h
  AgreesWithRig agrees_with_rig;
  bool is_realigned = false;  ///< rotations contradicted the extrinsics of the rig: they are estimated
  Eigen::Vector3d gravity_w = Eigen::Vector3d::Zero();
  /// Covariance of the direction of gravity [rad^2] in its tangent space (see gravity_direction.h) when the
  /// current initial prior was built; absent: gravity is constant.
  std::optional<Eigen::Matrix2d> gravity_covariance;
  bool inertial = false;                     ///< IMU initialized: gravity and velocities are valid
  LinearPrior prior;                         ///< marginalization prior on the states
  LinearPrior calibration;                   ///< prior on extrinsics, time offset and depth scale
  VectorPool<Observation> observation_pool;  ///< of removed landmarks
  VectorPool<ImuSample> sample_pool;         ///< of removed preintegrations

  [[nodiscard]] bool estimates_gravity() const { return inertial && gravity_covariance.has_value(); }
  /// Whether the newest frame was predicted by reliable inertial data.
  [[nodiscard]] bool has_inertial_prediction() const {
    return inertial && !frames.empty() && frames.back().imu_is_reliable;
  }
  /// Ends of the preintegration to `frame` >= 1; none if the states are defined there.
  [[nodiscard]] std::optional<std::array<ImuEnd, 2>> imu_ends(int frame) const {
    if (time_offset_model == TimeOffsetModel::kBearing) return std::nullopt;
    const auto end = [](const WindowFrame& f) { return ImuEnd{f.time_offset_s, f.gyro_b, f.accel_b}; };
    const auto index = static_cast<std::size_t>(frame);
    return std::array{end(frames[index - 1]), end(frames[index])};
  }
  [[nodiscard]] int newest() const { return static_cast<int>(frames.size()) - 1; }
  [[nodiscard]] Pose T_w_c(int frame) const {
    return frames[static_cast<std::size_t>(frame)].state.T_w_b * T_b_c;
  }

  /// Position in the world; the landmark's inverse depth must be known.
  [[nodiscard]] Eigen::Vector3d position(const Landmark& landmark) const {
    return position(landmark, landmark.inverse_depth);
  }
  /// Same at another inverse depth, > 0.
  [[nodiscard]] Eigen::Vector3d position(const Landmark& landmark, double inverse_depth) const {
    return T_w_c(landmark.host) *
           Eigen::Vector3d(landmark.observations.front().bearing.homogeneous() / inverse_depth);
  }
};

/// Whether a landmark is used in solve and marginalization.
[[nodiscard]] inline bool is_usable(const Landmark& landmark) {
  return !landmark.dynamic && landmark.inverse_depth > 0.0 && landmark.observations.size() >= 2;
}

}  // namespace stillpoint
