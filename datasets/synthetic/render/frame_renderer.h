// SPDX-License-Identifier: BSD-3-Clause
/// Ideal image of a pinhole camera: radiance, depth and labels per pixel, before the sensor models.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "datasets/synthetic/render/ray_tracer.h"
#include "datasets/synthetic/render/surface_tiles.h"
#include "datasets/synthetic/render/tile_shading.h"
#include "datasets/synthetic/render/world.h"

namespace stillpoint::synth {

/// Light samples per pixel, spread over exposure time and pixel area. The first lies in the pixel center at
/// mid-exposure and also yields depth and label. Four samples render motion blur without visible steps up to
/// about 8 px.
inline constexpr int kLightSamples = 4;

/// Time of light sample `index` relative to mid-exposure, in units of the exposure time: -0.5 .. 0.5.
[[nodiscard]] double sample_time_offset(int index);

/// Camera poses T_w_c during one frame. One entry: global shutter; otherwise one entry per image row.
struct Exposure {
  std::vector<std::array<Pose, kLightSamples>> poses;  ///< per row and light sample
  std::vector<float> mid_times;            ///< per row: mid-exposure as a fraction of the motion interval
  float exposure_fraction_of_span = 0.0F;  ///< exposure time / span_s
  float span_s = 1.0F;                     ///< length of the motion interval
};

/// Output of an ideal camera, in row-major order.
struct RenderedFrame {
  int width = 0;
  int height = 0;
  std::vector<Float4> radiance;       ///< linear; 1 = white paper in good light
  std::vector<float> depth_m;         ///< z depth at the pixel center; 0 = no surface
  std::vector<std::uint16_t> object;  ///< instance number; 0 = static world
  std::vector<float> speed_m_per_s;   ///< world-frame speed of the visible surface; 0 = static
};

/// Memory that is used again from frame to frame; one per thread.
struct RenderBuffers {
  RenderedFrame frame;
  SurfaceTiles quads, moving;
};

/// Renders a world through one camera. `render` is thread-safe.
class FrameRenderer {
 public:
  /// Stores references to `world` and `tracer`.
  FrameRenderer(const World& world, const RayTracer& tracer, const Camera& camera);

  /// Without buffers, for few frames. @param movers may be null
  [[nodiscard]] RenderedFrame render(const Exposure& exposure, const MoverFrame* movers) const {
    RenderBuffers buffers;
    render(exposure, movers, buffers);
    return std::move(buffers.frame);
  }

  /// @param movers may be null @return `buffers.frame`
  const RenderedFrame& render(const Exposure& exposure, const MoverFrame* movers,
                              RenderBuffers& buffers) const;

 private:
  struct Block;
  struct Job;
  struct LightSample;
  void see_surfaces(const Exposure& exposure, const MovingMesh* movers, RenderBuffers& buffers) const;
  template <class Function>
  void for_each_pixel(const Tile& tile, Function&& function) const;
  template <class Function>
  void for_each_block(const Tile& tile, Function&& function) const;
  void render_tile(Job& job, const Tile& tile, RenderedFrame& frame) const;
  [[nodiscard]] TileRays rays_through(const Tile& tile, std::size_t sample) const;
  void find_surfaces(const Job& job, const LightSample& sample, TileHits& hits) const;
  [[nodiscard]] RayPacket aim(const Job& job, const Block& block, const LightSample& sample) const;
  static void store(const RayPacket& packet, const Block& block, TileHits& hits);
  void record_geometry(const Job& job, const Tile& tile, const TileHits& hits, RenderedFrame& frame) const;
  [[nodiscard]] std::size_t pixel_at(int row, int column) const {
    return static_cast<std::size_t>(std::ptrdiff_t{row} * camera_.width + column);
  }

  const World& world_;
  const RayTracer& tracer_;
  Camera camera_;
  /// With distortion: normalized image coordinates (x, y) of every pixel, one table per light sample.
  std::array<std::vector<Eigen::Vector2f>, kLightSamples> directions_;
  /// Without: x of every column and y of every row, up to the ends of the last tiles.
  std::array<std::vector<float>, kLightSamples> column_x_, row_y_;
};

}  // namespace stillpoint::synth
