// SPDX-License-Identifier: BSD-3-Clause
/// Which features have stood at one place of the world for a while, whatever they did before. Our addition to
/// Paper Sec. III-E: a track that slid off a person onto the wall behind is a still point from then on.
#pragma once

#include <cstdint>
#include <vector>

#include "core/dynamic/moving_consistency.h"

namespace stillpoint {

/// Remembers where each feature was last seen to arrive, and how many pictures it has stayed there.
///
/// A place is taken where a depth was measured; to stay is to appear where that place projects to, which
/// needs no depth. So a depth read off the wrong side of an edge costs a few pictures, not the feature.
class RestingFeatures {
 public:
  /// @param pictures for which a feature must have stayed, >= 1
  /// @param stray_px that count as staying, px of the camera's focal length, > 0
  RestingFeatures(int pictures, double stray_px) : pictures_(pictures), stray_px_(stray_px) {}

  /// Takes up the newest picture, and forgets features that it does not see.
  /// @return ids of those at rest, rising; valid until the next call
  const std::vector<std::int64_t>& update(const ConsistencyView& view);

  void reset() { places_.clear(); }

 private:
  struct Place {
    std::int64_t id = 0;
    Eigen::Vector3d p_w = Eigen::Vector3d::Zero();
    int stayed = 0;  ///< pictures after the one that measured it
  };

  int pictures_;
  double stray_px_;
  std::vector<Place> places_;  ///< by rising id
  std::vector<Place> before_;  ///< the same at the picture before
  std::vector<std::int64_t> resting_;
};

}  // namespace stillpoint
