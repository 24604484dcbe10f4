// SPDX-License-Identifier: BSD-3-Clause
/// Scanned surfaces in PLY and OBJ files, read by Assimp.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "datasets/synthetic/render/world.h"

namespace stillpoint::synth {

/// Of all textures of a mesh: 2.7 GB with their mip levels.
inline constexpr std::size_t kMaxTexels = std::size_t{1} << 29;

/// Sets the mesh of `world` to the faces of a file [m] with the colors of their vertices or, where they have
/// one, their texture, whose image lies beside the file. Textures are added to those of `world`: their sides
/// become powers of two up to 8192 px, they repeat, and transparency is ignored.
/// @throws InputError if the file is not PLY or OBJ, cannot be read, or contains no triangles (a point
/// cloud), faces of vertices that it lacks, numbers that are not finite, triangles with neither color nor
/// texture, or texture coordinates per face or several textures of a PLY; if a texture cannot be read, or
/// they have more than `max_texels`
void read_mesh(const std::filesystem::path& file, World& world, std::size_t max_texels = kMaxTexels);

/// The files of materials and textures that a mesh names, as far as they exist; their contents change what is
/// rendered.
[[nodiscard]] std::vector<std::filesystem::path> companions_of_mesh(const std::filesystem::path& file);

}  // namespace stillpoint::synth
