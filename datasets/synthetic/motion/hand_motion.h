// SPDX-License-Identifier: BSD-3-Clause
/// Paths of a hand-held camera: sums of sinusoids, including hand tremor.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/geometry/pose.h"
#include "datasets/synthetic/motion/path_spline.h"

namespace stillpoint::synth {

/// The motions of the TUM RGB-D dynamic sequences (Sturm et al. 2012).
enum class HandMotion { kXyz, kStatic, kRpy, kHalfsphere };

/// Mean position of the camera, and the point it looks at.
struct Viewpoint {
  Eigen::Vector3d eye_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d target_w = Eigen::Vector3d::UnitX();
};

/// Attitude of a camera (z forward, y down) in a world with z up. Angles [rad]; yaw from the x axis towards
/// y, pitch positive downwards, roll positive clockwise as seen from behind the camera.
[[nodiscard]] Eigen::Quaterniond camera_attitude(double yaw, double pitch, double roll);

/// Path of the body that carries the camera. Mean speeds as listed for the TUM
/// sequences: xyz 0.2-0.3 m/s, rpy 20 deg/s (peaks 40-50), halfsphere 0.2 m/s and 18 deg/s, static 0.01 m/s.
/// Amplitudes ramp from 40 % to 100 % over the first two seconds, for a moving but gentle start.
[[nodiscard]] PathSpline hand_path(HandMotion motion, const Viewpoint& view, const PathRequest& request);

}  // namespace stillpoint::synth
