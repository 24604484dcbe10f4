// SPDX-License-Identifier: BSD-3-Clause
/// Who and what moves in a scene.
#pragma once

#include <vector>

#include "datasets/synthetic/actor.h"
#include "datasets/synthetic/path_spline.h"
#include "datasets/synthetic/presets.h"
#include "datasets/synthetic/scenes.h"

namespace stillpoint {

/// The people and movers of `request`; their textures are added to the scene's world.
/// @param camera_path path of the camera, out of whose way they keep; over [from_s, to_s]
[[nodiscard]] std::vector<Actor> cast_actors(const SynthRequest& request, Scene& scene,
                                             const std::function<Eigen::Vector2d(double t_s)>& camera_at,
                                             double from_s, double to_s);

}  // namespace stillpoint
