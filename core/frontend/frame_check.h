// SPDX-License-Identifier: BSD-3-Clause
/// Check of the images that enter the tracker.
#pragma once

#include "core/geometry/camera.h"
#include "core/types/frame.h"

namespace stillpoint {

/// @throws InputError unless the gray image is CV_8UC1 of the camera's size, and depth empty or CV_16UC1 of
/// that size
void check_frame(const Frame& frame, const Camera& camera);

}  // namespace stillpoint
