// SPDX-License-Identifier: BSD-3-Clause
/// Stiff pieces of things that move: limbs and boxes as small triangle meshes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace stillpoint {

/// A mesh in its own frame, with one texture.
struct RigidPart {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<Eigen::Vector2f> picture;  ///< places of the points in the texture, in its repeats
  std::vector<std::array<std::uint32_t, 3>> triangles;
  int texture = 0;
  float texels_per_m = 500.0F;
};

/// A rounded tube from the origin down to (0, 0, -length_m).
struct LimbShape {
  double length_m = 0.4;
  double top_radius_m = 0.07;
  double bottom_radius_m = 0.05;
  double depth_share = 1.0;  ///< thickness along x as a share of that along y
};

/// @param metres     of one repeat of the texture
/// @param texture_px side of the texture
[[nodiscard]] RigidPart make_limb(const LimbShape& shape, int texture, double metres, int texture_px);

/// A box whose sides each show the whole texture.
[[nodiscard]] RigidPart make_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int texture,
                                 int texture_px);

}  // namespace stillpoint
