// SPDX-License-Identifier: BSD-3-Clause
/// Which parts of a picture may show something that moves: elsewhere its rays need not be traced.
#pragma once

#include <span>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "datasets/synthetic/ray_tracer.h"

namespace stillpoint {

/// Square tiles of the picture, each marked or not.
class MoverTiles {
 public:
  /// Marks every tile that a triangle may touch at any time, seen from any of `views` or between them.
  /// @param views first and last camera pose T_w_c of the exposure
  MoverTiles(const MovingMesh& mesh, const Camera& camera, std::span<const Pose> views);

  [[nodiscard]] bool touches(int row, int column) const {
    return marked_[static_cast<std::size_t>(row / kTile_px * columns_ + column / kTile_px)];
  }

 private:
  static constexpr int kTile_px = 16;
  int columns_;
  int rows_;
  std::vector<bool> marked_;
};

}  // namespace stillpoint
