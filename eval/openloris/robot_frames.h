// SPDX-License-Identifier: BSD-3-Clause
/// Extrinsic calibration of the two OpenLORIS-Scene robots.
#pragma once

#include <string_view>

#include "core/geometry/pose.h"

namespace stillpoint::eval {

/// Pose T_base_sensor of a sensor in base_link, for the robot that recorded `scene`: one robot recorded
/// office, corridor, home and cafe, the other one market. Values of the OpenLORIS-Scene tools (MIT license).
/// @param scene in lower case
/// @param frame base_link, d400_color, d400_depth, d400_imu, t265_fisheye1, t265_fisheye2 or t265_imu
/// @throws InputError for an unknown scene or frame; the message lists the known ones
[[nodiscard]] Pose openloris_frame(std::string_view scene, std::string_view frame);

}  // namespace stillpoint::eval
