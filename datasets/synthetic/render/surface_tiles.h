// SPDX-License-Identifier: BSD-3-Clause
/// Parallelograms and triangles in an image of a camera without distortion: which of them each part of the
/// image may show, and the nearest one in each pixel, without rays.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "datasets/synthetic/render/mover_tiles.h"
#include "datasets/synthetic/render/pixel_group.h"
#include "datasets/synthetic/render/ray_tracer.h"
#include "datasets/synthetic/render/world.h"

namespace stillpoint::synth {

/// Part of an image: its upper left pixel.
struct Tile {
  static constexpr int kColumns = 16, kRows = 8, kPixels = kColumns * kRows;
  int row, column;
};

/// Where the light samples in the pixels of a tile lie, in normalized image coordinates, in row-major order.
struct TileRays {
  alignas(64) std::array<float, Tile::kPixels> x, y;
};

/// What the light samples in the pixels of a tile show, in row-major order.
struct TileHits {
  enum class Content { kNothing, kOneSurface, kAny };  ///< kOneSurface: the same static one in all pixels
  Content content = Content::kNothing;
  alignas(64) std::array<float, Tile::kPixels> inverse_z;  ///< of the depth along the optical axis [1/m]
  alignas(64) std::array<float, Tile::kPixels> u, v;       ///< coordinates in the surface
  static constexpr std::int32_t kMoving = 1 << 30;
  /// -1: nothing; a quad of the world, after the quads a triangle of its mesh; kMoving + a triangle of the
  /// moving mesh.
  alignas(64) std::array<std::int32_t, Tile::kPixels> surface;

  void clear();
};

/// a x + b y + c in normalized image coordinates.
struct LinearForm {
  float a = 0.0F, b = 0.0F, c = 0.0F;
};

/// A parallelogram o + u e_u + v e_v, or the half of it with u + v <= 1, seen along d = (x, y, 1) in
/// normalized image coordinates from p:
///
///   1 / z = n . d / (n . (o - p)),   u / z = a_u . (p - o) / z + a_u . d,   v / z likewise
///
/// n: normal; a_u, a_v: dual basis of the edges. They are linear in x and y, and so are the distances from
/// the edges, divided by z: the nearest surface is found without a division.
struct SeenSurface {
  LinearForm inverse_depth, u, v;    ///< 1 / z, u / z, v / z
  std::array<LinearForm, 4> inside;  ///< not negative in the surface
  std::int32_t surface;              ///< see TileHits
};

/// The different times of light samples in a frame; the first is in the middle.
inline constexpr std::size_t kSampleTimes = 3;
using SampleInstants = std::array<Instant, kSampleTimes>;

/// Surfaces are sorted into tiles once for all sample times of a frame, between which they move little. Its
/// memory is used again from image to image.
class SurfaceTiles {
 public:
  /// Replaces all surfaces by the parallelograms of a world. @param camera without distortion
  void see_quads(std::span<const Quad> quads, const Camera& camera, const SampleInstants& instants);

  /// Replaces all surfaces by the triangles of a moving mesh, but for those whose back is seen (the mesh is
  /// closed, and its triangles are counterclockwise seen from outside), and those that are hidden by
  /// `before`, seen by the same camera at the same times.
  void see_triangles(const MovingMesh& mesh, const SampleInstants& instants, const SurfaceTiles& before);

  /// Light samples of the pixels of a tile.
  struct Query {
    Tile tile;
    std::size_t time;      ///< number of the sample time
    const TileRays& rays;  ///< at most 0.75 px beside the centers of their pixels
  };

  /// Replaces hits by nearer ones; among surfaces at the same depth (to 1e-5), the one with the lowest
  /// number. Surfaces nearer than 1 mm are not seen.
  void find(const Query& query, TileHits& hits) const;

 private:
  /// A surface in a tile.
  struct Entry {
    std::uint32_t tile, seen;
    std::uint8_t first_row, end_row, first_column, end_column;  ///< of the tile
    std::uint8_t edges;  ///< bit i: not all pixels of the tile are inside of edge i
    bool covers;         ///< all pixels of the tile
    float nearest;       ///< largest inverse depth in the tile [1/m]
  };
  struct Outline;
  void begin(const Camera& camera);
  /// Bits of the sides of the image (left, right, top, bottom) on whose plane's far side a point is.
  [[nodiscard]] unsigned sides_beyond(const Eigen::Vector3f& p) const;
  template <std::size_t kCorners>
  void add(const std::array<std::array<Eigen::Vector3f, kCorners>, kSampleTimes>& corners_c,
           const std::array<bool, kSampleTimes>& is_front, std::int32_t surface);
  void add_to_tiles(const Outline& outline);
  void add_to_row(int row, const Outline& outline);
  void add_to_tile(const Tile& tile, const Outline& outline, Entry entry);
  void sort_entries();

  Camera camera_;
  int columns_ = 0, rows_ = 0;
  std::vector<float> low_x_, high_x_;  ///< sides of the columns of tiles, in normalized coordinates
  float left_ = 0.0F, right_ = 0.0F, top_ = 0.0F,
        bottom_ = 0.0F;  ///< sides of the image, in normalized coordinates, outward
  std::array<std::vector<SeenSurface>, kSampleTimes> seen_;
  std::vector<Entry> entries_, sorted_;  ///< `sorted_` by tile and number
  /// Per tile: inverse depth behind which everything is hidden [1/m]; padded for loads of eight.
  std::vector<float> covered_;
  std::vector<std::uint32_t> first_;  ///< per tile: in sorted_
  std::array<std::vector<Eigen::Vector3f>, kSampleTimes> points_c_;
  std::vector<unsigned> beyond_;  ///< per point: sides beyond which it is at all times
};

}  // namespace stillpoint::synth
