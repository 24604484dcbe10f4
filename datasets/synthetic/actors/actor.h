// SPDX-License-Identifier: BSD-3-Clause
/// Moving objects of a scene: rigid parts (limbs and boxes as small triangle meshes) whose poses are
/// functions of time.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose.h"
#include "datasets/io/sequence_info.h"
#include "datasets/synthetic/render/frame_renderer.h"

namespace stillpoint::synth {

/// A mesh in its own frame, with one texture.
struct RigidPart {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<Eigen::Vector2f> uv;  ///< texture coordinates of the points; 1 = one repeat
  std::vector<std::array<std::uint32_t, 3>> triangles;
  int texture = 0;
  float texels_per_m = 500.0F;
};

/// A capsule-like tube from the origin down to (0, 0, -length_m).
struct LimbShape {
  double length_m = 0.4;
  double top_radius_m = 0.07;
  double bottom_radius_m = 0.05;
  double depth_ratio = 1.0;  ///< thickness along x divided by thickness along y
};

/// @param repeat_m   size of one texture repeat [m]
/// @param texture_px side length of the texture
[[nodiscard]] RigidPart make_limb(const LimbShape& shape, int texture, double repeat_m, int texture_px);

/// A box; each side shows the whole texture.
[[nodiscard]] RigidPart make_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int texture,
                                 int texture_px);

struct Actor {
  int object = 1;                     ///< instance number in the labels
  std::string class_name = "person";  ///< as in true_boxes.txt
  std::vector<RigidPart> parts;
  std::function<std::vector<Pose>(double t_s)> poses_at;  ///< T_w_part of each part; thread-safe
};

/// Merges the parts of all actors into one mesh with vertex positions at both ends of a time interval.
[[nodiscard]] MoverFrame assemble_movers(std::span<const Actor> actors, double start_s, double end_s);

}  // namespace stillpoint::synth
