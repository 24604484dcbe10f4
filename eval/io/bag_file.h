// SPDX-License-Identifier: BSD-3-Clause
/// Rejects ROS bags, which are not read, with the way to export them.
#pragma once

#include <filesystem>
#include <string_view>

namespace stillpoint::eval {

/// How to export a trajectory, and the data of a sequence.
inline constexpr std::string_view kExportTrajectory =
    "export the trajectory as TUM text, e.g. with `evo_traj bag FILE TOPIC --save_as_tum` (bag2 for ROS 2)";
inline constexpr std::string_view kExportSequence =
    "extract its images and IMU samples to a sequence folder, e.g. with `kalibr_bagextractor`";

/// A bag is recognized by its name: a file .bag, .mcap or .db3, or a folder with metadata.yaml and one of
/// these files, as `ros2 bag` writes it.
/// @throws InputError with the remedy if the path is a bag
void reject_bag(const std::filesystem::path& path, std::string_view remedy);

}  // namespace stillpoint::eval
