// SPDX-License-Identifier: BSD-3-Clause
/// The rotation that levels the world of a run, from its result.json.
#pragma once

#include <filesystem>
#include <optional>

#include <Eigen/Geometry>

namespace stillpoint::bench {

/// Reads the member "leveling_rotation_xyzw".
/// @return nullopt if the file has no such member
/// @throws InputError if the file is no JSON object, or if the member is no rotation
[[nodiscard]] std::optional<Eigen::Quaterniond> read_leveling_rotation(
    const std::filesystem::path& result_json);

}  // namespace stillpoint::bench
