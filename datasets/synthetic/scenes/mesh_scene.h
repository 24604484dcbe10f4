// SPDX-License-Identifier: BSD-3-Clause
/// A scene that a user has scanned.
#pragma once

#include <filesystem>
#include <span>

#include "core/geometry/pose.h"
#include "datasets/synthetic/scenes/scenes.h"

namespace stillpoint::synth {

/// The mesh of a file, z up, whose colors are shown as they are, and a route for people where they fit: in
/// the middle of the free space around the mean position of the camera, on the floor below it. There is no
/// route if less than 1 m is free in most directions.
/// @param file see `read_mesh`
/// @param path camera poses T_w_c in the frame of the mesh, not empty
/// @throws InputError as `read_mesh`; if the mesh is larger than 1 km, that is, hardly in meters; if the
/// camera is far from it, mostly upside down or on its side, or never sees it
[[nodiscard]] Scene build_mesh_scene(const std::filesystem::path& file, std::span<const Pose> path);

}  // namespace stillpoint::synth
