// SPDX-License-Identifier: BSD-3-Clause
/// Image tiles that may show moving geometry; rays elsewhere need not be tested against it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "datasets/synthetic/render/ray_tracer.h"

namespace stillpoint::synth {

/// A camera pose T_w_c, and a ray time of the moving mesh.
struct Instant {
  Pose T_w_c;
  float time = 0.0F;
};

/// Small image tiles, each marked or not.
class MoverTiles {
 public:
  /// Marks every tile that a triangle may overlap at one of `instants`, or at any time between several.
  MoverTiles(const MovingMesh& mesh, const Camera& camera, std::span<const Instant> instants);

  [[nodiscard]] bool is_marked(int row, int column) const {
    return marked_[static_cast<std::size_t>(std::ptrdiff_t{row / kRows} * columns_ + column / kColumns)] != 0;
  }

 private:
  static constexpr int kColumns = 4, kRows = 2;  ///< of a tile: the pixels of a packet of rays
  int columns_;
  int rows_;
  std::vector<std::uint8_t> marked_;
};

}  // namespace stillpoint::synth
