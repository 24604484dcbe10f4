// SPDX-License-Identifier: BSD-3-Clause
/// How good the verdicts on features are, held against what a renderer knows of every pixel.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "bench/run/slid_tracks.h"
#include "core/types/feature_verdict.h"
#include "core/types/tracked_frame.h"
#include "datasets/sensor_stream.h"

namespace stillpoint {

/// Features, counted once in each picture.
///
/// Left out: features born in the picture, which no check can know yet; those on the outline of an object,
/// where a corner belongs to both sides; and those on a mover that rests, where either verdict is right. A
/// person who rests counts as one who moves.
struct VerdictScore {
  struct Share {
    std::int64_t all = 0;
    std::int64_t flagged = 0;
    /// Nothing where there are no features.
    [[nodiscard]] std::optional<double> share() const {
      if (all == 0) return std::nullopt;
      return static_cast<double>(flagged) / static_cast<double>(all);
    }
  };
  Share people;
  Share unknown_movers;
  Share background;

  /// Of what was flagged, what is on a person or a mover.
  [[nodiscard]] std::optional<double> precision() const;

  /// @param features of the picture; `verdicts` of the same, both by rising id
  /// @param slid     has seen the picture
  void add(std::span<const TrackedFeature> features, std::span<const FeatureVerdict> verdicts,
           const MotionLabels& labels, const SlidTracks& slid);
};

}  // namespace stillpoint
