// SPDX-License-Identifier: BSD-3-Clause
/// Recognition of places that were visited before, with temporal consistency (Galvez-Lopez and Tardos 2012,
/// Sec. V-B and V-C: islands of neighboring keyframes, and their consistency over successive queries).
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "core/config/loop_config.h"
#include "core/loop/place_index.h"

namespace stillpoint {

class PlaceRecognition {
 public:
  explicit PlaceRecognition(const LoopConfig& config) : config_(config) {}

  /// Adds all keyframes as places, whenever they were visited: those of an earlier run or segment.
  /// @param keyframes the first ones are those that are places already
  void add_all(std::span<const Keyframe> keyframes);

  /// Places that look like the newest keyframe, the most similar first, at most `loop.max_candidates`. Each
  /// is a maximum of the votes among its neighbors, older than the newest keyframe by `loop.min_gap_s`, and
  /// close to a candidate of one of the two previous queries.
  /// @param keyframes all, by time; the newest is the query. Earlier calls passed the same ones without it.
  [[nodiscard]] std::vector<PlaceVotes> recognize(std::span<const Keyframe> keyframes);

  /// Places that look like a single frame, the most similar first, without temporal consistency: maxima of at
  /// least `loop.min_votes` among the places of the map and the keyframes that `recognize` has indexed.
  [[nodiscard]] std::vector<PlaceVotes> similar_places(const Keyframe& query) const;

  [[nodiscard]] std::size_t memory_bytes() const { return index_.memory_bytes(); }

 private:
  [[nodiscard]] bool is_consistent(int place) const;

  LoopConfig config_;
  PlaceIndex index_;
  std::deque<std::vector<PlaceVotes>> recent_;  ///< candidates of the previous queries
};

/// Local maxima of the votes, the largest first; a smaller one among the neighbors of a larger is left out.
/// @param votes by ascending place
[[nodiscard]] std::vector<PlaceVotes> vote_maxima(std::span<const PlaceVotes> votes);

}  // namespace stillpoint
