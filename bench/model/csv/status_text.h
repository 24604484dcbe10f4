// SPDX-License-Identifier: BSD-3-Clause
/// Text of status.csv: what the odometry claims about each frame.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pose.h"

namespace stillpoint::bench {

/// A row of status.csv.
struct FrameClaim {
  std::int64_t frame = 0;
  std::int64_t t_ns = 0;  ///< timestamp of the image
  std::string status;
  int segment = 0;         ///< number of the world frame
  Pose T_w_c;              ///< also of frames that the trajectory does not contain
  double sigma_m = 0.0;    ///< of the position along its least certain direction; 0 = not reported
  double sigma_rad = 0.0;  ///< same for the rotation
};

[[nodiscard]] std::string claim_text(std::span<const FrameClaim> claims);

/// Without the poses.
/// @param place name of the text in error messages
/// @throws InputError for a malformed text
[[nodiscard]] std::vector<FrameClaim> parse_claims(std::string_view text, const std::string& place);

}  // namespace stillpoint::bench
