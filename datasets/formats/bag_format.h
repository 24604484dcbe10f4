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

}  // namespace stillpoint::datasets
