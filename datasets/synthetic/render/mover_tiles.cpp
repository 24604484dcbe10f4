// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render/mover_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace stillpoint::synth {
namespace {

constexpr float kMargin_px = 1.0F;        // light samples are up to 0.45 px beside the center of their pixel
constexpr float kMotionMargin_px = 6.0F;  // allowance for non-linear image motion between several instants
constexpr float kNearest_m = 0.05F;       // triangles with closer points mark all tiles

/// Bits of the sides of the image (left, right, top, bottom) on whose plane's far side a point is. A triangle
/// whose corners are all beyond one side is not visible, also if it crosses the plane of the camera.
unsigned sides_beyond(const Eigen::Vector3f& p_c, const Camera& camera, float margin_px) {
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  const auto width = static_cast<float>(camera.width), height = static_cast<float>(camera.height);
  const float x = fx * p_c.x(), y = fy * p_c.y(), z = p_c.z();
  return static_cast<unsigned>(x + (cx + margin_px) * z < 0.0F) |
         static_cast<unsigned>(x + (cx - width - margin_px) * z > 0.0F) << 1U |
         static_cast<unsigned>(y + (cy + margin_px) * z < 0.0F) << 2U |
         static_cast<unsigned>(y + (cy - height - margin_px) * z > 0.0F) << 3U;
}

struct Bounds {
  float x_min = 1e9F, x_max = -1e9F, y_min = 1e9F, y_max = -1e9F;
  bool near = false, ahead = false;
  unsigned beyond = 0b1111;  ///< sides of the image beyond which all points are

  void add(const Eigen::Vector3f& p_c, const Camera& camera, float margin_px) {
    ahead = ahead || p_c.z() > 0.0F;
    beyond &= sides_beyond(p_c, camera, margin_px);
    if (p_c.z() < kNearest_m) {
      near = true;
      return;
    }
    const Eigen::Vector2f pixel = camera.project(p_c.cast<double>()).cast<float>();
    x_min = std::min(x_min, pixel.x()), x_max = std::max(x_max, pixel.x());
    y_min = std::min(y_min, pixel.y()), y_max = std::max(y_max, pixel.y());
  }
  void add(const Bounds& other) {
    x_min = std::min(x_min, other.x_min), x_max = std::max(x_max, other.x_max);
    y_min = std::min(y_min, other.y_min), y_max = std::max(y_max, other.y_max);
    near = near || other.near, ahead = ahead || other.ahead;
    beyond &= other.beyond;
  }
};

std::vector<Bounds> vertex_bounds(const MovingMesh& mesh, const Camera& camera,
                                  std::span<const Instant> instants, float margin_px) {
  std::vector<Bounds> bounds(mesh.start.size());
  for (const auto& [T_w_c, time] : instants) {
    const Eigen::Matrix3f R_c_w = T_w_c.R().transpose().cast<float>();
    const Eigen::Vector3f center = T_w_c.p.cast<float>();
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      const Eigen::Vector3f point = mesh.start[i] + time * (mesh.end[i] - mesh.start[i]);
      bounds[i].add(R_c_w * (point - center), camera, margin_px);
    }
  }
  return bounds;
}

int tile_of(float pixel, int tile_px, int count) {
  return static_cast<int>(
      std::clamp(std::floor(pixel / static_cast<float>(tile_px)), 0.0F, static_cast<float>(count - 1)));
}

}  // namespace

MoverTiles::MoverTiles(const MovingMesh& mesh, const Camera& camera, std::span<const Instant> instants)
    : columns_((camera.width + kColumns - 1) / kColumns),
      rows_((camera.height + kRows - 1) / kRows),
      marked_(static_cast<std::size_t>(columns_ * rows_)) {
  if (camera.has_distortion()) {  // which folds points far outside of the image back into it
    marked_.assign(marked_.size(), 1);
    return;
  }
  const float margin_px = instants.size() > 1 ? kMotionMargin_px : kMargin_px;
  const std::vector<Bounds> vertices = vertex_bounds(mesh, camera, instants, margin_px);
  for (const std::array<std::uint32_t, 3>& corners : mesh.triangles) {
    Bounds triangle = vertices[corners[0]];
    triangle.add(vertices[corners[1]]);
    triangle.add(vertices[corners[2]]);
    if (!triangle.ahead || triangle.beyond != 0) continue;
    if (triangle.near) triangle = {-1e9F, 1e9F, -1e9F, 1e9F, true, true};
    const int left = tile_of(triangle.x_min - margin_px, kColumns, columns_);
    const int right = tile_of(triangle.x_max + margin_px, kColumns, columns_);
    const int bottom = tile_of(triangle.y_max + margin_px, kRows, rows_);
    for (int row = tile_of(triangle.y_min - margin_px, kRows, rows_); row <= bottom; ++row) {
      std::fill_n(marked_.begin() + std::ptrdiff_t{row} * columns_ + left, right - left + 1, 1);
    }
  }
}

}  // namespace stillpoint::synth
