// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render/mover_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace stillpoint::synth {
namespace {

constexpr float kMargin_px = 6.0F;   // allowance for non-linear image motion between the views
constexpr float kNearest_m = 0.05F;  // triangles with closer points mark all tiles

/// Bits of the sides of the image (left, right, top, bottom) on whose plane's far side a point is. A triangle
/// whose corners are all beyond one side is not visible, also if it crosses the plane of the camera.
unsigned sides_beyond(const Eigen::Vector3f& p_c, const Camera& camera) {
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  const auto width = static_cast<float>(camera.width), height = static_cast<float>(camera.height);
  const float x = fx * p_c.x(), y = fy * p_c.y(), z = p_c.z();
  return static_cast<unsigned>(x + (cx + kMargin_px) * z < 0.0F) |
         static_cast<unsigned>(x + (cx - width - kMargin_px) * z > 0.0F) << 1U |
         static_cast<unsigned>(y + (cy + kMargin_px) * z < 0.0F) << 2U |
         static_cast<unsigned>(y + (cy - height - kMargin_px) * z > 0.0F) << 3U;
}

struct Bounds {
  float x_min = 1e9F, x_max = -1e9F, y_min = 1e9F, y_max = -1e9F;
  bool near = false, ahead = false;
  unsigned beyond = 0b1111;  ///< sides of the image beyond which all points are

  void add(const Eigen::Vector3f& p_c, const Camera& camera) {
    ahead = ahead || p_c.z() > 0.0F;
    beyond &= sides_beyond(p_c, camera);
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

std::vector<Bounds> vertex_bounds(const MovingMesh& mesh, const Camera& camera, std::span<const Pose> views) {
  std::vector<Bounds> bounds(mesh.start.size());
  for (const Pose& T_w_c : views) {
    const Eigen::Matrix3f R_c_w = T_w_c.R().transpose().cast<float>();
    const Eigen::Vector3f center = T_w_c.p.cast<float>();
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      bounds[i].add(R_c_w * (mesh.start[i] - center), camera);
      bounds[i].add(R_c_w * (mesh.end[i] - center), camera);
    }
  }
  return bounds;
}

int tile_of(float pixel, int tile_px, int count) {
  return static_cast<int>(
      std::clamp(std::floor(pixel / static_cast<float>(tile_px)), 0.0F, static_cast<float>(count - 1)));
}

}  // namespace

MoverTiles::MoverTiles(const MovingMesh& mesh, const Camera& camera, std::span<const Pose> views)
    : columns_((camera.width + kTile_px - 1) / kTile_px),
      rows_((camera.height + kTile_px - 1) / kTile_px),
      marked_(static_cast<std::size_t>(columns_ * rows_)) {
  if (camera.has_distortion()) {  // which folds points far outside of the image back into it
    marked_.assign(marked_.size(), true);
    return;
  }
  const std::vector<Bounds> vertices = vertex_bounds(mesh, camera, views);
  for (const std::array<std::uint32_t, 3>& corners : mesh.triangles) {
    Bounds triangle = vertices[corners[0]];
    triangle.add(vertices[corners[1]]);
    triangle.add(vertices[corners[2]]);
    if (!triangle.ahead) continue;
    if (triangle.near && triangle.beyond != 0) continue;
    if (triangle.near) triangle = {-1e9F, 1e9F, -1e9F, 1e9F, true, true};
    const bool outside = triangle.x_max < -kMargin_px || triangle.y_max < -kMargin_px ||
                         triangle.x_min > static_cast<float>(camera.width) + kMargin_px ||
                         triangle.y_min > static_cast<float>(camera.height) + kMargin_px;
    if (outside) continue;
    const int left = tile_of(triangle.x_min - kMargin_px, kTile_px, columns_);
    const int right = tile_of(triangle.x_max + kMargin_px, kTile_px, columns_);
    const int bottom = tile_of(triangle.y_max + kMargin_px, kTile_px, rows_);
    for (int row = tile_of(triangle.y_min - kMargin_px, kTile_px, rows_); row <= bottom; ++row) {
      std::fill_n(marked_.begin() + std::ptrdiff_t{row} * columns_ + left, right - left + 1, true);
    }
  }
}

}  // namespace stillpoint::synth
