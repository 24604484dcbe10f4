// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/place_recognition.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace stillpoint {
namespace {

constexpr int kNeighbors = 2;              // keyframes to either side that see the same place
constexpr int kMaxStep = 4;                // keyframes between the candidates of successive queries
constexpr std::size_t kRecentQueries = 2;  // that confirm a candidate
constexpr std::size_t kMaxMaxima = 8;      // remembered per query

}  // namespace

std::vector<PlaceVotes> vote_maxima(std::span<const PlaceVotes> votes) {
  std::vector<PlaceVotes> ordered(votes.begin(), votes.end());
  std::ranges::sort(ordered, [](const PlaceVotes& a, const PlaceVotes& b) {
    return std::make_pair(-a.votes, a.place) < std::make_pair(-b.votes, b.place);
  });
  std::vector<PlaceVotes> maxima;
  for (const PlaceVotes& place : ordered) {
    if (maxima.size() == kMaxMaxima) break;
    const bool overlaps = std::ranges::any_of(maxima, [&](const PlaceVotes& maximum) {
      return std::abs(maximum.place - place.place) <= kNeighbors;
    });
    if (!overlaps) maxima.push_back(place);
  }
  return maxima;
}

void PlaceRecognition::add_all(std::span<const Keyframe> keyframes) {
  for (const Keyframe& keyframe : keyframes.subspan(static_cast<std::size_t>(index_.places())))
    index_.add(keyframe.features);
}

std::vector<PlaceVotes> PlaceRecognition::recognize(std::span<const Keyframe> keyframes) {
  const Keyframe& query = keyframes.back();
  while (index_.places() + 1 < static_cast<int>(keyframes.size())) {
    const Keyframe& next = keyframes[static_cast<std::size_t>(index_.places())];
    if (seconds_between(next.t, query.t) < config_.min_gap_s) break;
    index_.add(next.features);
  }
  std::vector<PlaceVotes> maxima = similar_places(query);
  std::vector<PlaceVotes> candidates;
  for (const PlaceVotes& place : maxima) {
    if (static_cast<int>(candidates.size()) == config_.max_candidates) break;
    if (is_consistent(place.place)) candidates.push_back(place);
  }
  recent_.push_back(std::move(maxima));
  if (recent_.size() > kRecentQueries) recent_.pop_front();
  return candidates;
}

std::vector<PlaceVotes> PlaceRecognition::similar_places(const Keyframe& query) const {
  std::vector<PlaceVotes> maxima = vote_maxima(index_.query(query.features));
  std::erase_if(maxima, [&](const PlaceVotes& place) { return place.votes < config_.min_votes; });
  return maxima;
}

bool PlaceRecognition::is_consistent(int place) const {
  return std::ranges::any_of(recent_, [&](const std::vector<PlaceVotes>& maxima) {
    return std::ranges::any_of(
        maxima, [&](const PlaceVotes& before) { return std::abs(before.place - place) <= kMaxStep; });
  });
}

}  // namespace stillpoint
