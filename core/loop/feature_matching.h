// SPDX-License-Identifier: BSD-3-Clause
/// Correspondences between the features of two keyframes.
#pragma once

#include <span>
#include <vector>

#include "core/loop/keyframe.h"

namespace stillpoint {

/// Indices of two similar features.
struct FeatureMatch {
  int query = 0;
  int match = 0;
};

/// Pairs of features that are mutually most similar: at most 64 different bits, and less than 0.9 of those of
/// the second-most similar feature of the match, unless that one is the same point (closer than 5 cm).
/// Exhaustive comparison.
[[nodiscard]] std::vector<FeatureMatch> match_features(std::span<const KeyframeFeature> query,
                                                       std::span<const KeyframeFeature> match);

}  // namespace stillpoint
