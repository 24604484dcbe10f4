// SPDX-License-Identifier: BSD-3-Clause
/// Detects tracks that no longer follow their initial scene point, from the ground-truth trajectory and the
/// measured depth.
#pragma once

#include <map>
#include <optional>

#include "core/types/rig.h"
#include "core/types/tracked_frame.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::bench {

/// Tracks drift at T-junctions of two edges, or when an occluding object passes. The feature then moves
/// although the scene is static, and neither dynamic label is wrong.
class DriftedTracks {
 public:
  /// Keeps a reference to `info`.
  explicit DriftedTracks(const datasets::SequenceInfo& info) : info_(info) {}

  /// Adds a frame; tracks without an observation in it are removed.
  void add(const TrackedFrame& frame);

  /// Whether the point p_w of the track's first depth measurement has a reprojection error of more than 4 px
  /// in the current or the first image: || project(T_w_c^-1 p_w) - pixel || > 4 px.
  /// False for tracks without measured depth, and without ground truth.
  [[nodiscard]] bool contains(std::int64_t id) const;

 private:
  struct Observation {
    Pose T_w_c;
    Eigen::Vector2d pixel;
  };
  struct Track {
    Observation first;
    std::optional<Eigen::Vector3d> p_w;  ///< from its first depth measurement
    bool drifted = false;
  };
  [[nodiscard]] bool exceeds_drift(const Eigen::Vector3d& p_w, const Observation& observation) const;

  const datasets::SequenceInfo& info_;
  std::map<std::int64_t, Track> tracks_;
};

}  // namespace stillpoint::bench
