// SPDX-License-Identifier: BSD-3-Clause
/// Recognizes the bags of ROS 1 and ROS 2, whose poses `stillpoint eval` reads as BAG:/TOPIC.
#pragma once

#include <filesystem>

namespace stillpoint::eval {

/// Whether the path is a bag by its name: a file .bag, .mcap or .db3, or a folder with metadata.yaml and one
/// of these files, as `ros2 bag` writes it.
[[nodiscard]] bool is_bag(const std::filesystem::path& path);

}  // namespace stillpoint::eval
