// SPDX-License-Identifier: BSD-3-Clause
/// Reads a bag with selected topics; see `kBagFormat` for the topics by type and name.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "datasets/formats/formats.h"

namespace stillpoint::datasets {

/// Frames are pairs of color and depth images less than 20 ms apart. The camera is that of CameraInfo, the
/// extrinsic that of /tf_static; depth of another camera is registered.
/// @param requested "ROLE=TOPIC", see `select_topics`
/// @throws InputError if the bag is damaged, or has no images
[[nodiscard]] SequenceContent read_bag_sequence(const std::filesystem::path& path,
                                                std::span<const std::string> requested, FaultLog& faults);

/// Accelerations in g, as in VCU-RVI, are converted to m/s^2, with a warning. There, their sign is inverted
/// as well: the specific force of a camera that is held upright points along -y of the camera, not along y.
/// @param content with its final calibration: a bag without transforms has its extrinsic in a rig.toml
[[nodiscard]] SequenceContent with_metric_accelerations(SequenceContent content);

}  // namespace stillpoint::datasets
