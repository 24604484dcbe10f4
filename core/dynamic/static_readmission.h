// SPDX-License-Identifier: BSD-3-Clause
/// Readmission of dynamic features that have been static for a number of frames. Extends Paper Sec. III-E: a
/// track that drifted from a person onto the background is static from then on, although its older
/// observations are not.
#pragma once

#include <cstdint>
#include <vector>

#include "core/dynamic/moving_consistency.h"

namespace stillpoint {

/// Stores an anchor point for each feature, and counts the frames in which the feature was observed there.
///
/// An anchor p_w = T_w_c (d * m) is set from an observation with valid depth d and bearing m. A later frame
/// counts as static if focal_px * || pi(T_w_c^-1 p_w) - m || <= static_residual_px, which needs no depth in
/// that frame; otherwise the anchor is set anew. An anchor with a depth from the wrong side of an edge
/// therefore delays the readmission by a few frames only.
class StaticReadmission {
 public:
  /// @param min_static_frames  consecutive static frames before a feature is readmitted, >= 1
  /// @param static_residual_px largest reprojection error of a static feature, px of the focal length, > 0
  StaticReadmission(int min_static_frames, double static_residual_px)
      : min_static_frames_(min_static_frames), static_residual_px_(static_residual_px) {}

  /// Processes the newest frame; removes features that are not observed in it.
  /// @return ids of the readmitted features, ascending; valid until the next call
  const std::vector<std::int64_t>& update(const ConsistencyView& view);

  void reset() { anchors_.clear(); }

 private:
  struct Anchor {
    std::int64_t id = 0;
    Eigen::Vector3d p_w = Eigen::Vector3d::Zero();
    int static_frames = 0;  ///< consecutive, after the frame that set the anchor
  };

  int min_static_frames_;
  double static_residual_px_;
  std::vector<Anchor> anchors_;   ///< by ascending id
  std::vector<Anchor> previous_;  ///< those of the previous frame
  std::vector<std::int64_t> readmitted_;
};

}  // namespace stillpoint
