// SPDX-License-Identifier: BSD-3-Clause
/// Light on standing surfaces, computed once: soft shadows of the lamps, and darker corners (ambient
/// occlusion, Zhukov et al. 1998).
#pragma once

#include "datasets/synthetic/ray_tracer.h"
#include "datasets/synthetic/world.h"

namespace stillpoint {

/// Irradiance of an upward lamp-lit point without any shadow: for things that move.
/// @param normal unit
[[nodiscard]] float open_light(const World& world, const Eigen::Vector3f& point,
                               const Eigen::Vector3f& normal);

/// Bilinear irradiance at (u, v) in [0, 1]^2 of a quad whose nodes were baked.
[[nodiscard]] float baked_light(const World& world, const Quad& quad, float u, float v);

/// Fills `world.light` and each quad's place in it.
void bake_light(World& world, const RayTracer& tracer, std::uint64_t seed);

}  // namespace stillpoint
