// SPDX-License-Identifier: BSD-3-Clause
/// Creates the moving objects of a scene.
#pragma once

#include <vector>

#include "datasets/synthetic/actors/actor.h"
#include "datasets/synthetic/actors/movers.h"
#include "datasets/synthetic/motion/path_spline.h"
#include "datasets/synthetic/scenes/scenes.h"
#include "datasets/synthetic/sequence/presets.h"

namespace stillpoint::synth {

/// Creates the people and other moving objects of `request`; adds their textures to the scene's world.
/// @param camera actors avoid it
/// @throws InputError if the scene has no routes or too few seats for the requested actors
[[nodiscard]] std::vector<Actor> populate_scene(const SynthRequest& request, Scene& scene,
                                                const CameraMotion& camera);

}  // namespace stillpoint::synth
