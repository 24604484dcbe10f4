// SPDX-License-Identifier: BSD-3-Clause
/// The light that the pixels of a tile receive from the surfaces that their light samples show.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "datasets/synthetic/render/ray_tracer.h"
#include "datasets/synthetic/render/surface_tiles.h"
#include "datasets/synthetic/render/world.h"

namespace stillpoint::synth {

/// SIMD vector of red, green, blue and one unused lane; a compiler extension of GCC and Clang.
using Float4 = float __attribute__((vector_size(16)));

/// Label and material of one triangle of the moving mesh.
struct MoverTriangle {
  int object = 1;                     ///< instance number, from 1
  int texture = 0;                    ///< in the world's textures
  std::array<Eigen::Vector2f, 3> uv;  ///< texture coordinates of the corners
  float texels_per_m = 500.0F;
};

/// All moving geometry of one frame.
struct MoverFrame {
  MovingMesh mesh;
  std::vector<Eigen::Vector3f> normals;   ///< per vertex
  std::vector<MoverTriangle> appearance;  ///< per triangle
};

/// What can be seen in a frame.
struct VisibleWorld {
  const World* world;
  const MoverFrame* movers;  ///< may be null
  /// Per vertex of the movers, computed where it is first needed; negative: not yet.
  std::vector<float> vertex_light{};

  /// Irradiance at a vertex of the movers.
  [[nodiscard]] float light(std::uint32_t vertex);
};

/// One light sample of each pixel of a tile.
struct TileSample {
  const TileRays& rays;
  const TileHits& hits;
  std::array<const Eigen::Matrix3f*, Tile::kRows> R_w_c;  ///< per row
  float pixel_size;                                       ///< of a pixel in normalized image coordinates
  float level_bias;  ///< added to the mip level before it is rounded down
};

/// Sums up the light samples of the pixels of a tile. Each step treats all pixels in a loop of SIMD
/// instructions; only texels and baked light are read one by one.
class TileShading {
 public:
  explicit TileShading(VisibleWorld& visible) : visible_(visible) {
    lit_surface_.fill(-1);
    irradiance_.fill(0.0F);
  }

  /// Adds a light sample with a weight.
  void add(const TileSample& sample, float weight);

  /// Sum of the light of a pixel: red, green, blue.
  [[nodiscard]] Float4 light(std::size_t at) const {
    return Float4{light_[0][at], light_[1][at], light_[2][at], 0.0F};
  }

 private:
  template <class T>
  struct alignas(64) PerPixel : std::array<T, Tile::kPixels> {};
  /// a + u b + v c.
  template <class T>
  struct Linear {
    T a, b, c;

    /// By the values at (0, 0), (1, 0) and (0, 1).
    static Linear through(const T& a, const T& b, const T& c) { return {a, T(b - a), T(c - a)}; }
  };
  /// What a surface shows, by its coordinates u and v.
  struct Appearance {
    std::int32_t surface = -1;       ///< see TileHits
    Linear<Eigen::Vector3f> normal;  ///< in camera coordinates, of any length
    Linear<float> s, t;
    Linear<float> irradiance{};   ///< unless baked
    const Quad* baked = nullptr;  ///< whose light is baked
    std::int32_t texture = -1, highest_level = 0;
    float texels_per_m = 1.0F;
    const Eigen::Matrix3f* R_w_c = nullptr;  ///< by which `normal` was rotated
  };
  static constexpr std::size_t kKept = 16;  ///< a power of two
  static std::array<Linear<float>, 2> texture_coordinates(const std::array<Eigen::Vector2f, 3>& uv);
  const Appearance& appearance(std::int32_t surface, const Eigen::Matrix3f* R_w_c);
  [[nodiscard]] Appearance new_appearance(std::int32_t surface, const Eigen::Matrix3f& R_w_c);
  [[nodiscard]] Appearance mover_appearance(std::size_t triangle);
  void find_texels(const TileSample& sample);
  template <std::size_t kPixels>
  void find_texels(const Appearance& appearance, std::size_t first, const TileSample& sample);
  void light_up(const Appearance& appearance, std::size_t first, const TileHits& hits);
  void light_up_all(const Appearance& appearance, const TileHits& hits);
  void show_texels_of_one(const TileSample& sample);
  void find_mips();
  void read_texels(const TileHits& hits);
  void read_corner_colors(const TileHits& hits);
  void blend(float weight);

  VisibleWorld& visible_;
  std::array<Appearance, kKept> appearances_{};  ///< the last ones, by the low bits of the surface
  PerPixel<float> s_, t_;                        ///< texture coordinates
  PerPixel<std::int32_t> texture_;               ///< -1: none, or the colors of the corners of a triangle
  PerPixel<std::int32_t> level_;
  PerPixel<const std::uint32_t*> mip_;         ///< its texels
  PerPixel<std::int32_t> columns_{}, rows_{};  ///< of the mip level: powers of two
  PerPixel<float> weight_x_, weight_y_;        ///< of the right and the lower texels
  /// The left and the right texel per pixel, of the upper and the lower row.
  alignas(64) std::array<std::array<std::uint32_t, 2 * Tile::kPixels>, 2> texels_{};
  PerPixel<float> irradiance_;
  PerPixel<std::int32_t> lit_surface_;  ///< of which `irradiance_` is
  bool one_is_lit_ = false;             ///< lit_surface_ is the same in all pixels
  std::array<PerPixel<float>, 3> light_{};
};

}  // namespace stillpoint::synth
