// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/place_index.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <utility>

namespace stillpoint {
namespace {

constexpr int kDescriptorBits = 256;
constexpr int kMaxVoteDistance = 48;  // bits; the distance of unrelated descriptors is 128 +- 8 or more
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
    tables_[table].newest.assign(std::size_t{1} << kKeyBits, -1);
  }
}

std::size_t PlaceIndex::key_of(const Table& table, const Descriptor& descriptor) {
  std::size_t key = 0;
  for (const std::uint8_t bit : table.bits) key = key << 1 | (descriptor[bit / 64] >> (bit % 64) & 1);
  return key;
}

void PlaceIndex::add(std::span<const KeyframeFeature> features) {
  for (const KeyframeFeature& feature : features.first(std::min(features.size(), kMaxFeatures))) {
    Entry entry{.descriptor = feature.descriptor, .place = places_};
    for (std::size_t table = 0; table < tables_.size(); ++table) {
      std::int32_t& newest = tables_[table].newest[key_of(tables_[table], entry.descriptor)];
      entry.next[table] = std::exchange(newest, static_cast<std::int32_t>(entries_.size()));
    }
    entries_.push_back(entry);
  }
  ++places_;
}

std::vector<PlaceVotes> PlaceIndex::query(std::span<const KeyframeFeature> features) const {
  std::vector<int> votes(static_cast<std::size_t>(places_), 0);
  std::vector<std::size_t> voter(votes.size(), 0);  // the last feature that voted, counted from 1
  const std::size_t used = std::min(features.size(), kMaxFeatures);
  for (std::size_t i = 0; i < used; ++i) {
    const Descriptor& descriptor = features[i].descriptor;
    for (std::size_t table = 0; table < tables_.size(); ++table) {
      std::int32_t next = tables_[table].newest[key_of(tables_[table], descriptor)];
      for (int compared = 0; next >= 0 && compared < kMaxEntries; ++compared) {
        const Entry& entry = entries_[static_cast<std::size_t>(next)];
        const auto place = static_cast<std::size_t>(entry.place);
        if (voter[place] != i + 1 && hamming_distance(entry.descriptor, descriptor) <= kMaxVoteDistance) {
          voter[place] = i + 1;
          ++votes[place];
        }
        next = entry.next[table];
      }
    }
  }
  std::vector<PlaceVotes> result;
  for (std::size_t place = 0; place < votes.size(); ++place) {
    if (votes[place] > 0) result.push_back({static_cast<int>(place), votes[place]});
  }
  return result;
}

}  // namespace stillpoint
