// SPDX-License-Identifier: BSD-3-Clause
/// Recognition of places that were visited before: an incremental index of binary descriptors, and the
/// temporal consistency of its candidates.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/config/loop_config.h"
#include "core/loop/keyframe.h"

namespace stillpoint {

/// Number of features of a query that are similar to features of a place.
struct PlaceVotes {
  int place = 0;
  int votes = 0;
};

/// Incremental index of binary descriptors: locality-sensitive hashing by bit sampling (Indyk and Motwani
/// 1998, Sec. 4.2). There is no vocabulary: nothing is trained, and nothing is shipped.
///
/// Each of kTables tables has as key kKeyBits bits of the descriptor, drawn once. Two descriptors that differ
/// in a fraction f of their bits share a key of one table with probability (1 - f)^kKeyBits, and one of all
/// tables with 1 - (1 - (1 - f)^kKeyBits)^kTables: 43 % for f = 0.125, 2e-4 for unrelated ones (f = 0.5).
/// Entries with a common key are compared by their Hamming distance: first 64 bits, which are stored next to
/// the key, and all 256 only if those differ in at most kMaxSignatureDistance. Of two descriptors at the
/// largest distance of a vote, 48, that excludes 1e-5, of unrelated ones 98 %.
class PlaceIndex {
 public:
  PlaceIndex();

  /// Adds the features of the next place; places are numbered from 0. Uses the first `kMaxFeatures`.
  void add(std::span<const KeyframeFeature> features);

  /// Votes for each place with at least one, by ascending place. A feature of the query has one vote per
  /// place.
  [[nodiscard]] std::vector<PlaceVotes> query(std::span<const KeyframeFeature> features) const;

  [[nodiscard]] int places() const { return places_; }

  /// Allocated for the entries and descriptors [B].
  [[nodiscard]] std::size_t memory_bytes() const;

  static constexpr std::size_t kMaxFeatures = 300;  ///< per place and query: bounds memory and time

 private:
  static constexpr int kTables = 4;
  static constexpr int kKeyBits = 16;
  static constexpr std::size_t kMaxEntries = 400;  ///< compared per key: more are a repeated texture

  /// A feature in a table.
  struct Entry {
    std::array<std::uint32_t, 2> signature{};  ///< one word of the descriptor
    std::uint32_t descriptor = 0;              ///< index in `descriptors_`
  };
  struct Table {
    std::array<std::uint8_t, kKeyBits> bits{};
    std::vector<std::vector<Entry>> entries;  ///< of each key, by place
  };

  [[nodiscard]] static std::size_t key_of(const Table& table, const Descriptor& descriptor);
  [[nodiscard]] static std::array<std::uint32_t, 2> signature_of(const Descriptor& descriptor);

  std::array<Table, kTables> tables_;
  std::vector<Descriptor> descriptors_;
  std::vector<std::int32_t> place_of_;  ///< of each descriptor
  std::size_t entries_allocated_ = 0;   ///< in all tables
  int places_ = 0;
};

/// Places with temporal consistency (Galvez-Lopez and Tardos 2012, Sec. V-B and V-C: islands of neighboring
/// keyframes, and their consistency over successive queries).
class PlaceRecognition {
 public:
  explicit PlaceRecognition(const LoopConfig& config) : config_(config) {}

  /// Adds all keyframes as places, whenever they were visited: those of an earlier run or segment.
  /// @param keyframes the first ones are those that are places already
  void add_all(std::span<const Keyframe> keyframes);

  /// Places that look like the newest keyframe, the most similar first, at most two. Each
  /// is a maximum of the votes among its neighbors, older than the newest keyframe by `loop.min_gap_s`, and
  /// close to a candidate of one of the two previous queries.
  /// @param keyframes all, by time; the newest is the query. Earlier calls passed the same ones without it.
  [[nodiscard]] std::vector<PlaceVotes> recognize(std::span<const Keyframe> keyframes);

  /// Places that look like a single frame, the most similar first, without temporal consistency: maxima of at
  /// least twelve among the places of the map and the keyframes that `recognize` has indexed.
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
