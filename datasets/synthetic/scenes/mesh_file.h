// SPDX-License-Identifier: BSD-3-Clause
/// Scanned surfaces in PLY and OBJ files, read by Assimp.
#pragma once

#include <filesystem>

#include "datasets/synthetic/render/world.h"

namespace stillpoint::synth {

/// Sets the mesh of `world` to the faces of a file [m] with the colors of their vertices or, where they have
/// one, their texture, whose image lies beside the file. Textures are added to those of `world`; their sides
/// are enlarged to powers of two.
/// @throws InputError if the file is not PLY or OBJ, cannot be read, or contains no triangles (a point
/// cloud), coordinates that are not finite, or triangles with neither color nor texture; if a texture cannot
/// be read
void read_mesh(const std::filesystem::path& file, World& world);

}  // namespace stillpoint::synth
