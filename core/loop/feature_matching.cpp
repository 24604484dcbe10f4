// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/feature_matching.h"

#include <limits>

namespace stillpoint {
namespace {

constexpr int kMaxDistance = 64;       // bits
constexpr double kMaxRatio = 0.9;      // Lowe 2004, Sec. 7.1
constexpr float kSamePoint_m = 0.05F;  // a corner is often found on several image scales

/// The most similar feature, and the distance of the second-most similar that is another point.
struct Nearest {
  int index = -1;
  int distance = std::numeric_limits<int>::max();
  int second = std::numeric_limits<int>::max();
};

Nearest nearest_feature(const KeyframeFeature& feature, std::span<const KeyframeFeature> others) {
  Nearest nearest;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const int distance = hamming_distance(feature.descriptor, others[i].descriptor);
    if (distance < nearest.distance) {
      const bool other_point =
          nearest.index >= 0 &&
          (others[static_cast<std::size_t>(nearest.index)].p_c - others[i].p_c).norm() > kSamePoint_m;
      if (other_point) nearest.second = nearest.distance;
      nearest.index = static_cast<int>(i);
      nearest.distance = distance;
    } else if (distance < nearest.second &&
               (others[static_cast<std::size_t>(nearest.index)].p_c - others[i].p_c).norm() > kSamePoint_m) {
      nearest.second = distance;
    }
  }
  return nearest;
}

}  // namespace

std::vector<FeatureMatch> match_features(std::span<const KeyframeFeature> query,
                                         std::span<const KeyframeFeature> match) {
  std::vector<FeatureMatch> matches;
  for (std::size_t i = 0; i < query.size(); ++i) {
    const Nearest nearest = nearest_feature(query[i], match);
    if (nearest.distance > kMaxDistance || nearest.distance > kMaxRatio * nearest.second) continue;
    const Nearest back = nearest_feature(match[static_cast<std::size_t>(nearest.index)], query);
    if (back.index == static_cast<int>(i)) matches.push_back({static_cast<int>(i), nearest.index});
  }
  return matches;
}

}  // namespace stillpoint
