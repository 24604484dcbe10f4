// SPDX-License-Identifier: BSD-3-Clause
/// Writes small sequence folders of each format for tests.
#pragma once

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace stillpoint {

/// Three 8x6 color images at 1.00, 1.04, 1.08 s, depth images 5 ms later (raw value 5000), and ground truth
/// along x at 1 m/s from 0.9 to 1.2 s.
void write_tum_folder(const TemporaryFolder& folder);

/// The same with depth images of another size.
void write_tum_folder(const TemporaryFolder& folder, int depth_width, int depth_height);

/// Three 8x6 frames at 100.00, 100.04, 100.08 s, gyroscope at 400 Hz and accelerometer at 250 Hz from 99.9 s
/// on, ground truth of base_link, which is 1 m below the camera.
void write_openloris_folder(const TemporaryFolder& folder);

/// Three 8x6 gray images at 20 Hz from 1 s on, IMU at 200 Hz, ground truth of the body.
void write_euroc_folder(const TemporaryFolder& folder);

/// Frames 0 to 2 of 640x480, depth 1 m, poses along x at 1 cm per frame.
void write_seven_scenes_folder(const TemporaryFolder& folder);

/// color/ and depth/ 00007 to 00009 of 8x6, and a camera.json.
void write_plain_folder(const TemporaryFolder& folder);

}  // namespace stillpoint
