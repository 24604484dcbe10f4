// SPDX-License-Identifier: BSD-3-Clause
/// Where the sensors of the two OpenLORIS-Scene robots sit: the data set's own calibration.
#pragma once

#include <string_view>

#include "core/geometry/pose.h"

namespace stillpoint {

/// Pose T_base_sensor of a sensor frame in base_link, on the robot that recorded `scene`: one robot drove
/// office, corridor, home and cafe, the other the market. Values of the OpenLORIS-Scene tools (MIT licence).
/// @param frame base_link, d400_color, d400_depth, d400_imu, t265_fisheye1, t265_fisheye2 or t265_imu
/// @throws InputError for an unknown scene or frame, which names the known ones
[[nodiscard]] Pose openloris_frame(std::string_view scene, std::string_view frame);

}  // namespace stillpoint
