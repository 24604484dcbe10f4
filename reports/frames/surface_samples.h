// SPDX-License-Identifier: BSD-3-Clause
/// Static surfaces of a run for the 3-D view of the report page: a small point cloud by the poses of the run.
#pragma once

#include <optional>
#include <string>

#include "core/pipeline/runners/runner.h"
#include "datasets/mapping/voxel_map.h"

namespace stillpoint::report {

/// Adds a frame without the pixels that the semantic mask assigns to objects. Paper Eq. (1).
void add_static_pixels(datasets::VoxelMap& map, const Frame& frame, const Pose& T_w_c,
                       const SemanticMask& mask);

/// Fuses two located frames per second of the first world, at the poses that the trajectory of the run has.
class SurfaceSamples {
 public:
  explicit SurfaceSamples(const Camera& camera);

  /// Frames in order.
  void add(const FrameReport& report);

  /// At most 8000 points in a PLY file, as text in steps of 1 mm; empty without any, e.g. without depth
  /// images.
  [[nodiscard]] std::string ply() const;

 private:
  datasets::VoxelMap map_;
  std::optional<Timestamp> last_t_;  ///< of the last frame that was fused
};

}  // namespace stillpoint::report
