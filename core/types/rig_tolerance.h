// SPDX-License-Identifier: BSD-3-Clause
/// What a careful calibration leaves: a rig whose true values differ by as much is not doubted.
#pragma once

#include <array>

namespace stillpoint::rig_tolerance {

inline constexpr double kRotation_rad = 0.003;  ///< of the camera on the body: 0.2 degrees
inline constexpr double kLever_m = 0.01;        ///< same: translation
inline constexpr double kTimeOffset_s = 0.001;
/// An accelerometer of another scale looks like depth of another scale: data sheets of consumer sensors state
/// 0.5 to 1 %.
inline constexpr double kDepthScale = 0.006;
/// Focal length (relative), k1, and the principal point in focal lengths: half a pixel of 500.
inline constexpr std::array<double, 4> kLens{0.002, 0.004, 0.001, 0.001};

}  // namespace stillpoint::rig_tolerance
