// SPDX-License-Identifier: BSD-3-Clause
/// Which tracks have left the point of the standing world where they began, held against the true camera
/// path.
#pragma once

#include <map>
#include <optional>

#include "core/types/rig.h"
#include "core/types/tracked_frame.h"
#include "datasets/sensor_stream.h"

namespace stillpoint {

/// A tracker that follows a T-junction of two edges, or is dragged along by somebody who passes, slides off:
/// its feature then moves though nothing moves there, and both verdicts have their reasons.
class SlidTracks {
 public:
  /// Keeps a reference to `info`.
  explicit SlidTracks(const SequenceInfo& info) : info_(info) {}

  /// Takes up a picture, and forgets the tracks that it no longer has.
  void add(const TrackedFrame& frame);

  /// Whether the point where the track's depth was first measured is more than a few pixels away from it
  /// now, or was so when the track was born.
  /// False for tracks without any measured depth, and without ground truth.
  [[nodiscard]] bool contains(std::int64_t id) const;

 private:
  struct Sighting {
    Pose T_w_c;
    Eigen::Vector2d pixel;
  };
  struct Track {
    Sighting birth;
    std::optional<Eigen::Vector3d> p_w;  ///< where it was when its depth was first measured
    bool slid = false;
  };
  [[nodiscard]] bool is_off(const Eigen::Vector3d& p_w, const Sighting& sighting) const;

  const SequenceInfo& info_;
  std::map<std::int64_t, Track> tracks_;
};

}  // namespace stillpoint
