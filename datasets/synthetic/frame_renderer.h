// SPDX-License-Identifier: BSD-3-Clause
/// One exposure of a pinhole camera: light, depth and labels of every pixel, before any sensor touches them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "datasets/synthetic/ray_tracer.h"
#include "datasets/synthetic/world.h"

namespace stillpoint {

/// Moments (and places in the pixel) at which each pixel gathers light: the first in the pixel's centre at
/// mid-exposure, which also gives depth and label. Four make a blur without visible steps up to about 8 px of
/// motion.
inline constexpr int kLightSamples = 4;

/// Where, within the exposure, light sample `index` lies: -0.5 .. 0.5.
[[nodiscard]] double exposure_share(int index);

/// How one triangle of the moving mesh looks.
struct MoverTriangle {
  int object = 1;   ///< instance number, from 1
  int texture = 0;  ///< in the world's textures
  std::array<Eigen::Vector2f, 3> picture;
  float texels_per_m = 500.0F;
};

/// Everything that moves in one frame.
struct MoverFrame {
  MovingMesh mesh;
  std::vector<Eigen::Vector3f> normals;  ///< of the vertices
  std::vector<MoverTriangle> looks;      ///< of the triangles
};

/// Camera poses T_w_c of one frame. One row: global shutter; else one row per picture row.
struct Shot {
  std::vector<std::array<Pose, kLightSamples>> poses;  ///< per row
  std::vector<float> mid_times;         ///< per row: mid-exposure as a share of the movers' span of time
  float exposure_share_of_span = 0.0F;  ///< length of the exposure as a share of that span
  float span_s = 1.0F;                  ///< length of that span
};

/// What an ideal camera sees; row by row.
struct RenderedFrame {
  int width = 0;
  int height = 0;
  std::vector<Float4> radiance;  ///< linear, 1 = white paper in good light
  std::vector<float> depth_m;    ///< along the optical axis through the pixel's centre; 0 = nothing there
  std::vector<std::uint16_t> object;  ///< instance number; 0 = the standing world
  std::vector<float> speed_m_per_s;   ///< of what is seen, in the world; 0 = stands still
};

/// Draws a world through one camera. Rendering is safe from several threads at once.
class FrameRenderer {
 public:
  /// Keeps references to `world` and `tracer`.
  FrameRenderer(const World& world, const RayTracer& tracer, const Camera& camera);

  /// @param movers may be null
  [[nodiscard]] RenderedFrame render(const Shot& shot, const MoverFrame* movers) const;

 private:
  struct Block;
  struct Job;
  void record_geometry(const Job& job, const Block& block, const RayPacket& packet,
                       RenderedFrame& frame) const;
  void render_block(const Job& job, int block_row, int block_column, RenderedFrame& frame) const;
  [[nodiscard]] RayPacket aim(const Job& job, const Block& block, int sample) const;
  [[nodiscard]] Float4 shade(const Job& job, const RayPacket& packet, int lane, int sample) const;

  const World& world_;
  const RayTracer& tracer_;
  Camera camera_;
  /// Normalised directions (x, y) of every pixel, one table per light sample.
  std::array<std::vector<Eigen::Vector2f>, kLightSamples> directions_;
};

}  // namespace stillpoint
