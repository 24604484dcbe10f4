// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/place_recognition.h"

#include <gtest/gtest.h>

#include "tests/unit/loop/random_features.h"

namespace stillpoint {
namespace {

std::vector<Keyframe> keyframes_at_1hz(const std::vector<std::vector<KeyframeFeature>>& places) {
  std::vector<Keyframe> keyframes;
  for (const std::vector<KeyframeFeature>& features : places) {
    keyframes.push_back({.frame = static_cast<std::int64_t>(keyframes.size()),
                         .t = from_seconds(static_cast<double>(keyframes.size())),
                         .features = features});
  }
  return keyframes;
}

/// Candidates of the newest keyframe after all queries.
std::vector<PlaceVotes> recognized(const std::vector<Keyframe>& keyframes, const LoopConfig& config) {
  PlaceRecognition recognition(config);
  std::vector<PlaceVotes> candidates;
  for (std::size_t count = 1; count <= keyframes.size(); ++count)
    candidates = recognition.recognize(std::span(keyframes).first(count));
  return candidates;
}

std::vector<std::vector<KeyframeFeature>> distinct_places(int count, std::mt19937_64& random) {
  std::vector<std::vector<KeyframeFeature>> places;
  for (int i = 0; i < count; ++i) places.push_back(random_features(300, random));
  return places;
}

TEST(PlaceIndex, ItsMemoryIsThatOfTheTablesEntriesAndDescriptors) {
  // 4 tables of 2^16 keys with a vector each. A feature has an entry of 12 bytes per table, a descriptor of
  // 32 bytes and a place of 4 bytes; vectors allocate their first element without a reserve.
  PlaceIndex index;
  const std::size_t empty = 4 * 65536 * sizeof(std::vector<int>);
  EXPECT_EQ(index.memory_bytes(), empty);
  index.add(std::vector<KeyframeFeature>(1));
  EXPECT_EQ(index.memory_bytes(), empty + 4 * 12 + 32 + 4);
}

TEST(PlaceIndex, FindsAPlaceAmongOthersByNoisyDescriptors) {
  std::mt19937_64 random(1);
  const auto places = distinct_places(50, random);
  PlaceIndex index;
  for (const auto& features : places) index.add(features);
  const std::vector<PlaceVotes> maxima = vote_maxima(index.query(revisited(places[17], {}, random)));
  ASSERT_FALSE(maxima.empty());
  EXPECT_EQ(maxima.front().place, 17);
  // 20 of 256 bits differ: a key of 16 bits agrees with probability 0.925^16 = 0.29, one of four with 0.74.
  EXPECT_GT(maxima.front().votes, 190);
  EXPECT_TRUE(maxima.size() == 1 || maxima[1].votes < 5);
}

TEST(PlaceRecognition, ReportsAPlaceThatTwoSuccessiveQueriesFind) {
  std::mt19937_64 random(2);
  auto places = distinct_places(30, random);
  places.push_back(revisited(places[4], {}, random));
  const LoopConfig config{.min_gap_s = 10.0};
  EXPECT_TRUE(recognized(keyframes_at_1hz(places), config).empty()) << "one query alone";
  places.push_back(revisited(places[5], {}, random));
  const std::vector<PlaceVotes> candidates = recognized(keyframes_at_1hz(places), config);
  ASSERT_EQ(candidates.size(), 1u);
  EXPECT_EQ(candidates.front().place, 5);
}

TEST(PlaceRecognition, DoesNotReportTheRecentPast) {
  std::mt19937_64 random(3);
  auto places = distinct_places(10, random);
  places.push_back(revisited(places[8], {}, random));
  places.push_back(revisited(places[9], {}, random));
  EXPECT_TRUE(recognized(keyframes_at_1hz(places), {.min_gap_s = 5.0}).empty());
}

}  // namespace
}  // namespace stillpoint
