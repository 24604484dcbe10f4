// SPDX-License-Identifier: BSD-3-Clause
/// Scanned surfaces in PLY and OBJ files, read by Assimp.
#pragma once

#include <filesystem>
#include <vector>

#include "datasets/synthetic/render/world.h"

namespace stillpoint::synth {

/// Sets the mesh of `world` to the faces of a file [m] with the colors of their vertices or, where they have
/// one, their texture, whose image lies beside the file. Textures are added to those of `world`: their sides
/// become powers of two up to 8192 px, they repeat, and transparency is ignored.
/// @throws InputError if the file is not PLY or OBJ, cannot be read, or contains no triangles (a point
/// cloud), numbers that are not finite, triangles with neither color nor texture, or texture coordinates per
/// face of a PLY; if a texture cannot be read
void read_mesh(const std::filesystem::path& file, World& world);

/// The files of materials and textures that a mesh names, as far as they exist; their contents change what is
/// rendered.
[[nodiscard]] std::vector<std::filesystem::path> companions_of_mesh(const std::filesystem::path& file);

}  // namespace stillpoint::synth
