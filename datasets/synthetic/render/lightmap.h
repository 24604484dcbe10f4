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

/// Bilinear interpolation of the baked irradiance of a quad at (u, v) in [0, 1]^2.
[[nodiscard]] inline float baked_light(const World& world, const Quad& quad, float u, float v) {
  const float x = u * static_cast<float>(quad.light_columns - 1),
              y = v * static_cast<float>(quad.light_rows - 1);
  const int column = std::clamp(static_cast<int>(x), 0, quad.light_columns - 2);
  const int row = std::clamp(static_cast<int>(y), 0, quad.light_rows - 2);
  const float weight_x = x - static_cast<float>(column), weight_y = y - static_cast<float>(row);
  const float* lower =
      world.light.data() + quad.light_first + std::ptrdiff_t{row} * quad.light_columns + column;
  const float* upper = lower + quad.light_columns;
  const float bottom = lower[0] + (lower[1] - lower[0]) * weight_x;
  const float top = upper[0] + (upper[1] - upper[0]) * weight_x;
  return bottom + (top - bottom) * weight_y;
}

/// Computes `world.light` and the node grid of each quad in it.
void bake_light(World& world, const RayTracer& tracer, std::uint64_t seed);

}  // namespace stillpoint::synth
