// SPDX-License-Identifier: BSD-3-Clause
/// Static geometry of a synthetic scene: textured parallelograms, a mesh, and lamps.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/pose.h"
#include "datasets/synthetic/materials/texture.h"

namespace stillpoint::synth {

/// Region of a texture shown by a surface: upper left corner and size, in repeats of the texture.
struct TextureRegion {
  double s = 0.0;
  double t = 0.0;
  double width = 1.0;
  double height = 1.0;
};

/// One parallelogram; its front is the side that edge_u x edge_v points to.
struct Quad {
  Eigen::Vector3f origin, edge_u, edge_v;
  Eigen::Vector3f normal;
  int texture = 0;
  float s = 0.0F, t = 0.0F, s_per_u = 1.0F,
        t_per_v = 1.0F;       ///< texture coordinates at the origin and their slopes over u, v in [0, 1]
  float texels_per_m = 1.0F;  ///< geometric mean of both directions
  bool emissive = false;      ///< shows its texture independent of the light: lamps and screens
  bool one_sided = false;     ///< part of a closed surface: its back is not visible
  int light_first = 0, light_columns = 2,
      light_rows = 2;  ///< grid of this quad in World::light, see lightmap.h
};

/// Horizontal rectangular area light that emits downwards.
struct Lamp {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  float half_x = 0.3F, half_y = 0.3F;  ///< [m]
  float power = 1.0F;                  ///< irradiance (relative) at 1 m straight below
};

/// What a triangle of a mesh shows: its part of a texture, or the colors of its corners.
struct MeshTriangle {
  std::array<std::uint32_t, 3> corners{};  ///< in StaticMesh::vertices
  int texture = -1;                        ///< in World::textures; -1: the colors of the corners
  std::array<Eigen::Vector2f, 3> uv;       ///< texture coordinates of the corners
  float texels_per_m = 1.0F;
  /// Texels of the corners, the last one twice: bilinear interpolation in this 2 x 2 image at
  /// (u / (1 - v), v) is that of the triangle, (1 - u - v) c_0 + u c_1 + v c_2.
  std::array<std::uint32_t, 4> colors{};
};

/// A scanned surface. Its colors contain the light of the scan: it is shown without lamps and shadows, and
/// from both sides.
struct StaticMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<MeshTriangle> triangles;
};

/// The static part of a scene.
struct World {
  std::vector<Texture> textures;
  std::vector<Quad> quads;
  StaticMesh mesh;
  std::vector<Lamp> lamps;
  std::vector<float> light;  ///< irradiance at the lightmap nodes of all quads, see lightmap.h
  float ambient = 0.25F;     ///< ambient irradiance before occlusion
};

/// A surface to add: its upper left corner and its edges.
struct Parallelogram {
  Eigen::Vector3d corner, right, down;
};

/// A region of a texture.
struct Label {
  TextureRegion region;
  int texture = 0;
};

/// Approximated by a vertical prism of `sides` sides.
struct Cylinder {
  Eigen::Vector3d base;  ///< center of the lower disk
  double radius = 0.0;
  double height = 0.0;
  int sides = 12;
};

/// Adds parallelograms to a world in a local frame: x right, y to the back, z up.
class Builder {
 public:
  explicit Builder(World& world) : world_(world) {}

  /// @param rgb CV_8UC3 with power-of-two sides @return texture number
  int add_texture(const cv::Mat& rgb);

  /// Sets the local frame of all following calls: at `position` in the world, rotated by `yaw` [rad] about z.
  void set_frame(const Eigen::Vector3d& position, double yaw);

  /// Maps the upper left corner of the texture region to the corner, its upper edge to +right and its left
  /// edge to +down. The front is the side from which the texture is not mirrored.
  void add_textured_quad(const Parallelogram& area, int texture, const TextureRegion& region = {});

  /// A surface whose texture repeats every `repeat_m` [m].
  void add_surface(const Parallelogram& area, int texture, double repeat_m);

  /// A closed box with the same tiled texture on all six sides.
  void add_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int texture, double repeat_m);

  /// A box whose front (towards -y) shows a label and whose other sides show `side_texture`.
  void add_labeled_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Label& front,
                       int side_texture);

  /// A cylinder with a lid.
  void add_cylinder(const Cylinder& cylinder, int texture, double repeat_m);

  [[nodiscard]] World& world() { return world_; }

  /// Marks the last added quad as emissive.
  void mark_last_emissive() { world_.quads.back().emissive = true; }

  /// @param size along x and y [m]
  void add_lamp(const Eigen::Vector3d& center, const Eigen::Vector2d& size, double power, int texture);

 private:
  /// Marks the last added quads as those of a closed surface.
  void close_last(std::size_t count);
  Eigen::Vector3d to_world(const Eigen::Vector3d& point) const;
  Eigen::Vector3d rotate(const Eigen::Vector3d& vector) const;

  World& world_;
  Pose T_w_local_;
};

}  // namespace stillpoint::synth
