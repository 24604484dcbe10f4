// SPDX-License-Identifier: BSD-3-Clause
/// Image tiles that may show moving geometry; rays elsewhere need not be tested against it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "datasets/synthetic/render/ray_tracer.h"

namespace stillpoint::synth {

/// Square image tiles, each marked or not.
class MoverTiles {
 public:
  /// Marks every tile that a triangle may overlap at any time, from any of `views` or between them.
  /// @param views first and last camera pose T_w_c of the exposure
  MoverTiles(const MovingMesh& mesh, const Camera& camera, std::span<const Pose> views);

  [[nodiscard]] bool is_marked(int row, int column) const {
    return marked_[static_cast<std::size_t>(std::ptrdiff_t{row / kTile_px} * columns_ + column / kTile_px)];
  }

 private:
  static constexpr int kTile_px = 16;
  int columns_;
  int rows_;
  std::vector<bool> marked_;
};

}  // namespace stillpoint::synth
