// SPDX-License-Identifier: BSD-3-Clause
/// Creates the moving objects of a scene.
#pragma once

#include <vector>

#include "datasets/synthetic/actors/actor.h"
#include "datasets/synthetic/motion/path_spline.h"
#include "datasets/synthetic/scenes/scenes.h"
#include "datasets/synthetic/sequence/presets.h"

namespace stillpoint::synth {

/// Creates the people and other moving objects of `request`; adds their textures to the scene's world.
/// @param camera_at camera position on the floor over [from_s, to_s]; actors avoid it
/// @throws InputError if the scene has no routes or too few seats for the requested actors
[[nodiscard]] std::vector<Actor> populate_scene(const SynthRequest& request, Scene& scene,
                                                const std::function<Eigen::Vector2d(double t_s)>& camera_at,
                                                double from_s, double to_s);

}  // namespace stillpoint::synth
