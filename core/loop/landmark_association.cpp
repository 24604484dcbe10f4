// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/landmark_association.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <numeric>

#include "core/loop/feature_matching.h"

namespace stillpoint {
namespace {

constexpr std::size_t kMinObservations = 3;
constexpr int kLandmarksPerKeyframe = 150;
// Distance of a pair from the graph. An object that moves as one piece can have most of the matches.
constexpr double kMaxDistance_m = 0.1;
constexpr double kMaxAngle_rad = 2.0 * std::numbers::pi / 180.0;

/// Sets of features that are the same point: union by the smaller index, with path halving.
class FeatureSets {
 public:
  explicit FeatureSets(std::span<const Keyframe> keyframes) {
    for (const Keyframe& keyframe : keyframes) {
      first_.push_back(parents_.size());
      parents_.resize(parents_.size() + keyframe.features.size());
    }
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }

  [[nodiscard]] std::size_t find(std::size_t keyframe, int feature) {
    return root(first_[keyframe] + static_cast<std::size_t>(feature));
  }
  void join(std::size_t a, std::size_t b) { parents_[std::max(a, b)] = std::min(a, b); }
  [[nodiscard]] std::size_t root(std::size_t element) {
    while (parents_[element] != element) element = parents_[element] = parents_[parents_[element]];
    return element;
  }

 private:
  std::vector<std::size_t> first_;  ///< element of the first feature of each keyframe
  std::vector<std::size_t> parents_;
};

class Association {
 public:
  Association(std::span<const Keyframe> keyframes, std::span<const Pose> T_m_b,
              const RelativePoseOptions& options)
      : keyframes_(keyframes), T_m_b_(T_m_b), options_(options), sets_(keyframes) {}

  void join_tracks() {
    std::map<std::int64_t, std::size_t> first;  // element of the first observation of each track
    for (std::size_t k = 0; k < keyframes_.size(); ++k) {
      for (std::size_t f = 0; f < keyframes_[k].features.size(); ++f) {
        const std::int64_t track = keyframes_[k].features[f].track;
        if (track < 0) continue;
        const std::size_t element = sets_.find(k, static_cast<int>(f));
        const auto [found, is_new] = first.emplace(track, element);
        if (!is_new) sets_.join(sets_.root(found->second), element);
      }
    }
  }

  void join_matches(std::size_t query, std::size_t match) {
    const std::vector<KeyframeFeature>& of_query = keyframes_[query].features;
    const std::vector<KeyframeFeature>& of_match = keyframes_[match].features;
    const std::vector<FeatureMatch> matches = match_features(of_query, of_match);
    std::vector<PointPair> pairs;
    for (const FeatureMatch& found : matches) {
      pairs.push_back({of_query[static_cast<std::size_t>(found.query)].p_c.cast<double>(),
                       of_match[static_cast<std::size_t>(found.match)].p_c.cast<double>()});
    }
    const std::optional<EstimatedRelativePose> estimate = estimate_relative_pose(pairs, options_);
    if (!estimate || !is_close(T_m_c(match).inverse() * T_m_c(query), estimate->T_m_q)) return;
    for (const int inlier : estimate->inliers) {
      const FeatureMatch& found = matches[static_cast<std::size_t>(inlier)];
      sets_.join(sets_.find(query, found.query), sets_.find(match, found.match));
    }
  }

  [[nodiscard]] std::vector<MapLandmark> landmarks() {
    std::map<std::size_t, MapLandmark> of_sets;
    for (std::size_t k = 0; k < keyframes_.size(); ++k) {
      for (std::size_t f = 0; f < keyframes_[k].features.size(); ++f) {
        const Eigen::Vector3d p_c = keyframes_[k].features[f].p_c.cast<double>();
        of_sets[sets_.find(k, static_cast<int>(f))].observations.push_back({static_cast<int>(k), p_c});
      }
    }
    std::vector<MapLandmark> all;
    for (auto& [set, landmark] : of_sets) {
      if (!is_usable(landmark)) continue;
      landmark.p_m = median_position(landmark);
      all.push_back(std::move(landmark));
    }
    return all;
  }

 private:
  [[nodiscard]] Pose T_m_c(std::size_t k) const { return T_m_b_[k] * keyframes_[k].T_b_c; }

  /// The median of each coordinate, which few wrong observations do not move far.
  [[nodiscard]] Eigen::Vector3d median_position(const MapLandmark& landmark) const {
    Eigen::Vector3d median;
    std::vector<double> values(landmark.observations.size());
    for (int axis = 0; axis < 3; ++axis) {
      std::ranges::transform(landmark.observations, values.begin(), [&](const LandmarkObservation& seen) {
        return (T_m_c(static_cast<std::size_t>(seen.keyframe)) * seen.p_c)[axis];
      });
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      median[axis] = *middle;
    }
    return median;
  }

  [[nodiscard]] static bool is_close(const Pose& a, const Pose& b) {
    return (a.p - b.p).norm() < kMaxDistance_m && a.q.angularDistance(b.q) < kMaxAngle_rad;
  }

  [[nodiscard]] static bool is_usable(const MapLandmark& landmark) {
    const auto& seen = landmark.observations;
    const auto same = [](const LandmarkObservation& a, const LandmarkObservation& b) {
      return a.keyframe == b.keyframe;
    };
    return seen.size() >= kMinObservations && std::ranges::adjacent_find(seen, same) == seen.end();
  }

  std::span<const Keyframe> keyframes_;
  std::span<const Pose> T_m_b_;
  RelativePoseOptions options_;
  FeatureSets sets_;
};

/// Those that most keyframes see, until each of their keyframes has enough.
std::vector<MapLandmark> chosen_landmarks(std::vector<MapLandmark> all, std::size_t keyframes) {
  std::ranges::stable_sort(all, [](const MapLandmark& a, const MapLandmark& b) {
    return a.observations.size() > b.observations.size();
  });
  std::vector<int> counts(keyframes, 0);
  const auto count_of = [&](const LandmarkObservation& seen) -> int& {
    return counts[static_cast<std::size_t>(seen.keyframe)];
  };
  std::erase_if(all, [&](const MapLandmark& landmark) {
    const bool is_needed = std::ranges::any_of(
        landmark.observations, [&](const auto& seen) { return count_of(seen) < kLandmarksPerKeyframe; });
    if (!is_needed) return true;
    for (const LandmarkObservation& seen : landmark.observations) ++count_of(seen);
    return false;
  });
  return all;
}

}  // namespace

std::vector<MapLandmark> associate_landmarks(std::span<const Keyframe> keyframes, std::span<const Pose> T_m_b,
                                             std::span<const GraphLoop> loops,
                                             const RelativePoseOptions& options) {
  Association association(keyframes, T_m_b, options);
  association.join_tracks();
  for (const GraphLoop& loop : loops)
    association.join_matches(static_cast<std::size_t>(loop.query), static_cast<std::size_t>(loop.match));
  return chosen_landmarks(association.landmarks(), keyframes.size());
}

}  // namespace stillpoint
