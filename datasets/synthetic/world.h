// SPDX-License-Identifier: BSD-3-Clause
/// What stands still in a synthetic scene: textured parallelograms and lamps.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/geometry/pose.h"
#include "datasets/synthetic/texture.h"

namespace stillpoint {

/// Part of a picture that a surface shows: its upper left corner and size, in repeats of the picture.
struct PictureArea {
  double s = 0.0;
  double t = 0.0;
  double width = 1.0;
  double height = 1.0;
};

/// One parallelogram, seen from the side that edge_u x edge_v points to.
struct Quad {
  Eigen::Vector3f origin, edge_u, edge_v;
  Eigen::Vector3f normal;
  int texture = 0;
  float s = 0.0F, t = 0.0F, s_per_u = 1.0F,
        t_per_v = 1.0F;       ///< picture coordinates of the origin, and their growth
  float texels_per_m = 1.0F;  ///< geometric mean of both directions
  bool shines = false;        ///< shows its picture whatever the light: a screen
  int light_first = 0, light_columns = 2, light_rows = 2;  ///< nodes of the baked light, see lightmap.h
};

/// Lamp in the shape of a horizontal panel that shines downwards.
struct Lamp {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  float half_x = 0.3F, half_y = 0.3F;  ///< [m]
  float power = 1.0F;                  ///< irradiance [1] straight below, at 1 m
};

/// Everything that stands still in a scene.
struct World {
  std::vector<Texture> textures;
  std::vector<Quad> quads;
  std::vector<Lamp> lamps;
  std::vector<float> light;  ///< nodes of all quads, see lightmap.h
  float ambient = 0.25F;     ///< irradiance from everywhere, before occlusion
};

/// Lays parallelograms into a world in a local frame: x right, y to the back, z up.
class Builder {
 public:
  explicit Builder(World& world) : world_(world) {}

  /// @param picture CV_8UC3 with sides that are powers of two @return its number
  int add_texture(const cv::Mat& picture);

  /// From now on coordinates are in a frame at `position`, turned by `yaw` [rad] about z, in the world.
  void set_frame(const Eigen::Vector3d& position, double yaw);

  /// The picture's upper left corner comes to `corner`, its right to +right, its bottom to +down. Seen from
  /// the side from which the picture is not mirrored.
  void add_picture(const Eigen::Vector3d& corner, const Eigen::Vector3d& right, const Eigen::Vector3d& down,
                   int texture, const PictureArea& area = {});

  /// A surface whose picture repeats every `metres`.
  void add_surface(const Eigen::Vector3d& corner, const Eigen::Vector3d& right, const Eigen::Vector3d& down,
                   int texture, double metres);

  /// A closed box with one endless texture on all six sides.
  void add_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int texture, double metres);

  /// A box whose front (towards -y) shows part of a picture and whose other sides show `side_texture`.
  void add_labelled_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int front_texture,
                        const PictureArea& area, int side_texture);

  /// An upright cylinder of `sides` flat sides, with a lid.
  void add_cylinder(const Eigen::Vector3d& base, double radius, double height, int texture, double metres,
                    int sides = 12);

  /// The quad added last shines by itself.
  void make_last_shine() { world_.quads.back().shines = true; }

  void add_lamp(const Eigen::Vector3d& center, double size_x, double size_y, double power, int texture);

 private:
  Eigen::Vector3d to_world(const Eigen::Vector3d& point) const;
  Eigen::Vector3d turn(const Eigen::Vector3d& vector) const;

  World& world_;
  Pose T_w_local_;
};

}  // namespace stillpoint
