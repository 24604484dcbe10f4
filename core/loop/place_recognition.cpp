// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/place_recognition.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <random>
#include <utility>

namespace stillpoint {
namespace {

constexpr int kDescriptorBits = 256;
constexpr int kMaxVoteDistance = 48;  // bits; the distance of unrelated descriptors is 128 +- 8 or more
// Bits of 64: 12 are expected at the largest distance of a vote, 32 between unrelated descriptors.
constexpr int kMaxSignatureDistance = 24;
constexpr std::uint32_t kBitSeed = 1;

}  // namespace

PlaceIndex::PlaceIndex() {
  std::array<std::uint8_t, kDescriptorBits> bits{};
  std::iota(bits.begin(), bits.end(), std::uint8_t{0});
  std::mt19937 random(kBitSeed);
  // Fisher-Yates; std::shuffle is not specified to the bit.
  for (std::size_t i = bits.size() - 1; i > 0; --i) std::swap(bits[i], bits[random() % (i + 1)]);
  for (std::size_t table = 0; table < tables_.size(); ++table) {
    std::copy_n(bits.begin() + static_cast<std::ptrdiff_t>(table * kKeyBits), kKeyBits,
                tables_[table].bits.begin());
    tables_[table].entries.resize(std::size_t{1} << kKeyBits);
  }
}

std::size_t PlaceIndex::key_of(const Table& table, const Descriptor& descriptor) {
  std::size_t key = 0;
  for (const std::uint8_t bit : table.bits) key = key << 1 | (descriptor[bit / 64] >> (bit % 64) & 1);
  return key;
}

std::array<std::uint32_t, 2> PlaceIndex::signature_of(const Descriptor& descriptor) {
  return {static_cast<std::uint32_t>(descriptor[0]), static_cast<std::uint32_t>(descriptor[0] >> 32)};
}

void PlaceIndex::add(std::span<const KeyframeFeature> features) {
  for (const KeyframeFeature& feature : features.first(std::min(features.size(), kMaxFeatures))) {
    const Entry entry{.signature = signature_of(feature.descriptor),
                      .descriptor = static_cast<std::uint32_t>(descriptors_.size())};
    for (Table& table : tables_) {
      std::vector<Entry>& entries = table.entries[key_of(table, feature.descriptor)];
      const std::size_t capacity = entries.capacity();
      entries.push_back(entry);
      entries_allocated_ += entries.capacity() - capacity;
    }
    descriptors_.push_back(feature.descriptor);
    place_of_.push_back(places_);
  }
  ++places_;
}

std::size_t PlaceIndex::memory_bytes() const {
  return tables_.size() * (std::size_t{1} << kKeyBits) * sizeof(std::vector<Entry>) +
         entries_allocated_ * sizeof(Entry) + descriptors_.capacity() * sizeof(Descriptor) +
         place_of_.capacity() * sizeof(std::int32_t);
}

std::vector<PlaceVotes> PlaceIndex::query(std::span<const KeyframeFeature> features) const {
  std::vector<int> votes(static_cast<std::size_t>(places_), 0);
  std::vector<std::size_t> voter(votes.size(), 0);  // the last feature that voted, counted from 1
  const std::size_t used = std::min(features.size(), kMaxFeatures);
  for (std::size_t i = 0; i < used; ++i) {
    const Descriptor& descriptor = features[i].descriptor;
    const auto [low, high] = signature_of(descriptor);
    for (const Table& table : tables_) {
      const std::vector<Entry>& all = table.entries[key_of(table, descriptor)];
      for (const Entry& entry : std::span(all).last(std::min(all.size(), kMaxEntries))) {
        const int distance =
            std::popcount(entry.signature[0] ^ low) + std::popcount(entry.signature[1] ^ high);
        if (distance > kMaxSignatureDistance) continue;
        const auto place = static_cast<std::size_t>(place_of_[entry.descriptor]);
        if (voter[place] == i + 1) continue;
        if (hamming_distance(descriptors_[entry.descriptor], descriptor) > kMaxVoteDistance) continue;
        voter[place] = i + 1;
        ++votes[place];
      }
    }
  }
  std::vector<PlaceVotes> result;
  for (std::size_t place = 0; place < votes.size(); ++place) {
    if (votes[place] > 0) result.push_back({static_cast<int>(place), votes[place]});
  }
  return result;
}

namespace {

constexpr int kNeighbors = 2;              // keyframes to either side that see the same place
constexpr int kMaxStep = 4;                // keyframes between the candidates of successive queries
constexpr std::size_t kRecentQueries = 2;  // that confirm a candidate
constexpr std::size_t kMaxMaxima = 8;      // remembered per query
constexpr std::size_t kMaxCandidates = 2;  // verified per query: each costs a matching of all features

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
    if (candidates.size() == kMaxCandidates) break;
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
