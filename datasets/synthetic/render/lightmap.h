// SPDX-License-Identifier: BSD-3-Clause
/// Precomputed irradiance of static surfaces: area lights with soft shadows, and ambient occlusion (Zhukov et
/// al. 1998).
///
///   E(x, n) = sum_l P_l * mean_i [ V(x, y_i) * (n . d_i) * d_i,z / r_i^2 ] + E_a * (0.25 + 0.75 * A(x, n))
///
/// P_l: power of lamp l; y_i: random point on it; r_i, d_i: distance and unit direction from x to y_i;
/// V: visibility, 0 or 1; E_a: ambient irradiance; A: cosine-weighted unoccluded fraction of the hemisphere.
#pragma once

#include <algorithm>
#include <cstddef>

#include "datasets/synthetic/render/ray_tracer.h"
#include "datasets/synthetic/render/world.h"

namespace stillpoint::synth {

/// Irradiance without shadows and occlusion, for moving objects. @param normal unit vector
[[nodiscard]] float unshadowed_light(const World& world, const Eigen::Vector3f& point,
                                     const Eigen::Vector3f& normal);

/// Between four nodes of a quad.
struct LightCell {
  std::int32_t node;         ///< the first, in World::light
  float weight_x, weight_y;  ///< of the second along u and along v
};

/// Where (u, v) in [0, 1]^2 lies.
[[nodiscard]] inline LightCell light_cell(const Quad& quad, float u, float v) {
  const float x = u * static_cast<float>(quad.light_columns - 1),
              y = v * static_cast<float>(quad.light_rows - 1);
  const std::int32_t column = std::clamp(static_cast<std::int32_t>(x), 0, quad.light_columns - 2);
  const std::int32_t row = std::clamp(static_cast<std::int32_t>(y), 0, quad.light_rows - 2);
  return {quad.light_first + row * quad.light_columns + column, x - static_cast<float>(column),
          y - static_cast<float>(row)};
}

/// Bilinear interpolation of the baked irradiance.
[[nodiscard]] inline float light_in(const World& world, const Quad& quad, const LightCell& cell) {
  const float* const lower = world.light.data() + cell.node;
  const float* const upper = lower + quad.light_columns;
  const float bottom = lower[0] + (lower[1] - lower[0]) * cell.weight_x;
  const float top = upper[0] + (upper[1] - upper[0]) * cell.weight_x;
  return bottom + (top - bottom) * cell.weight_y;
}

/// The baked irradiance of a quad at (u, v) in [0, 1]^2.
[[nodiscard]] inline float baked_light(const World& world, const Quad& quad, float u, float v) {
  return light_in(world, quad, light_cell(quad, u, v));
}

/// Computes `world.light` and the node grid of each quad in it.
void bake_light(World& world, const RayTracer& tracer, std::uint64_t seed);

}  // namespace stillpoint::synth
