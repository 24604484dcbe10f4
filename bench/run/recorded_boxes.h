// SPDX-License-Identifier: BSD-3-Clause
/// Checks that a sequence has the recorded boxes that a config requires. Without them a run would mask no
/// dynamic object, and its errors would be taken for those of the method.
#pragma once

#include <filesystem>

#include "core/config/odometry_config.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::bench {

/// @throws InputError naming the file and both remedies if the config uses recorded boxes and the sequence
/// has none, or none for any of its frames
void require_recorded_boxes(const OdometryConfig& config, const datasets::SequenceInfo& info);

/// The same for a folder that is not opened yet: only the existence of detections.txt is checked.
void require_recorded_boxes(const OdometryConfig& config, const std::filesystem::path& folder);

}  // namespace stillpoint::bench
