// SPDX-License-Identifier: BSD-3-Clause
/// The state that the estimator refines: frames of the sliding window, landmarks, calibration and the prior.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/backend/factors/linear_prior.h"
#include "core/base/spare_vectors.h"
#include "core/imu/preintegration.h"
#include "core/types/nav_state.h"
#include "core/types/rig.h"

namespace stillpoint {

/// One landmark seen in one frame of the window.
struct Observation {
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();   ///< normalised plane
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< of the bearing [1/s]
  double depth = 0.0;                                  ///< [m]; 0 = not measured or not believed
  double read_out_s = 0.0;                             ///< exposure of its row minus that of the middle row
};

/// Where the present depth of a landmark comes from.
enum class DepthSource { kNone, kMeasured, kTriangulated };

/// A point of the world, by its inverse depth in the frame that saw it first (its host).
struct Landmark {
  std::int64_t id = 0;
  int host = 0;                           ///< index of the first observing frame
  std::vector<Observation> observations;  ///< one for each frame from host on, without a hole
  double inverse_depth = 0.0;             ///< [1/m], in the host; 0 = unknown
  DepthSource source = DepthSource::kNone;
  bool dynamic = false;  ///< moves: tracked, but kept out of the estimate

  [[nodiscard]] int last() const { return host + static_cast<int>(observations.size()) - 1; }
  [[nodiscard]] bool seen_in(int frame) const { return frame >= host && frame <= last(); }
  [[nodiscard]] const Observation& in(int frame) const {
    return observations[static_cast<std::size_t>(frame - host)];
  }
};

/// One picture in the window. The state is that of IMU time `state.t + time_offset_s`.
struct WindowFrame {
  std::int64_t id = 0;
  NavState state;
  double time_offset_s = 0.0;                        ///< offset in force when the frame came
  Eigen::Vector3d gyro_b = Eigen::Vector3d::Zero();  ///< angular rate at the exposure, bias included [rad/s]
  std::optional<Preintegration> from_previous;       ///< absent in the first frame and without an IMU
};

struct Window {
  std::vector<WindowFrame> frames;  ///< oldest first
  std::vector<Landmark> landmarks;  ///< by rising id
  Pose T_b_c;
  double time_offset_s = 0.0;
  Eigen::Vector3d gravity_w = Eigen::Vector3d::Zero();
  bool inertial = false;    ///< the IMU takes part: the world is level and speeds are known
  LinearPrior prior;        ///< what gone frames said about the states
  LinearPrior calibration;  ///< what the rig says about its extrinsics and time offset
  SpareVectors<Observation> spare_observations;  ///< of landmarks that have left
  SpareVectors<ImuSample> spare_samples;         ///< of preintegrations that have left

  [[nodiscard]] int newest() const { return static_cast<int>(frames.size()) - 1; }
  [[nodiscard]] Pose T_w_c(int frame) const {
    return frames[static_cast<std::size_t>(frame)].state.T_w_b * T_b_c;
  }

  /// Position in the world; the landmark's inverse depth must be known.
  [[nodiscard]] Eigen::Vector3d position(const Landmark& landmark) const {
    return position(landmark, landmark.inverse_depth);
  }
  /// The same at another inverse depth, > 0.
  [[nodiscard]] Eigen::Vector3d position(const Landmark& landmark, double inverse_depth) const {
    return T_w_c(landmark.host) *
           Eigen::Vector3d(landmark.observations.front().bearing.homogeneous() / inverse_depth);
  }
};

/// Whether a landmark takes part in solve and marginalisation.
[[nodiscard]] inline bool is_usable(const Landmark& landmark) {
  return !landmark.dynamic && landmark.inverse_depth > 0.0 && landmark.observations.size() >= 2;
}

}  // namespace stillpoint
