// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/map_file.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

KeyframeMap small_map() {
  KeyframeMap map;
  for (int i = 0; i < 3; ++i) {
    Keyframe keyframe{.frame = 10 * i,
                      .t = from_seconds(0.5 * i),
                      .T_w_b = {exp_so3({0.1 * i, 0.2, 0.3}), {1.0 * i, 2.0, 3.0}},
                      .T_b_c = {exp_so3({0.0, 0.1, 0.0}), {0.01, 0.02, 0.03}}};
    if (i > 0) keyframe.gravity_b = Eigen::Vector3d(0.0, 0.6, -0.8);
    keyframe.features.resize(static_cast<std::size_t>(i), {{1, 2, 3, 4}, {0.5F, -0.5F, 2.0F}});
    map.keyframes.push_back(keyframe);
  }
  return map;
}

TEST(MapFile, TheChecksumIsThatOfTheContent) {
  KeyframeMap map = small_map();
  const std::string checksum = map_checksum(map);
  EXPECT_EQ(checksum, map_checksum(parse_map(map_bytes(map), "map")));
  map.keyframes[1].T_w_b.p.x() += 1e-9;
  EXPECT_NE(checksum, map_checksum(map));
}

TEST(MapFile, ReadsWhatWasWritten) {
  const KeyframeMap map = small_map(), read = parse_map(map_bytes(map), "map");
  ASSERT_EQ(read.keyframes.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Keyframe &a = map.keyframes[i], &b = read.keyframes[i];
    EXPECT_EQ(a.frame, b.frame);
    EXPECT_EQ(a.t, b.t);
    EXPECT_EQ(a.T_w_b.p, b.T_w_b.p);
    EXPECT_EQ(a.T_w_b.q.coeffs(), b.T_w_b.q.coeffs());
    EXPECT_EQ(a.T_b_c.p, b.T_b_c.p);
    EXPECT_EQ(a.gravity_b, b.gravity_b);
    ASSERT_EQ(a.features.size(), b.features.size());
    for (std::size_t k = 0; k < a.features.size(); ++k) {
      EXPECT_EQ(a.features[k].descriptor, b.features[k].descriptor);
      EXPECT_EQ(a.features[k].p_c, b.features[k].p_c);
    }
  }
}

TEST(MapFile, TenMinutesFitInto100Megabytes) {
  // A keyframe every 0.15 m at 1 m/s is one per 0.15 s: 4000 in 10 minutes, with 560 features each.
  KeyframeMap map;
  map.keyframes.resize(1);
  map.keyframes[0].features.resize(560);
  EXPECT_LT(4000 * map_bytes(map).size(), 100'000'000U);
}

TEST(MapFile, RejectsEveryTruncationAndEveryChangedByte) {
  const std::string bytes = map_bytes(small_map());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(static_cast<void>(parse_map(bytes.substr(0, size), "map")), InputError) << size;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_THROW(static_cast<void>(parse_map(damaged, "map")), InputError) << i;
  }
}

TEST(MapFile, NamesTheFileAndTheRemedy) {
  const TemporaryFolder folder;
  const std::string foreign = folder.write("a.map", "something else").string();
  expect_input_error([&] { static_cast<void>(read_map(foreign)); }, {foreign, "is not a map", "--save-map"});
  std::string newer = map_bytes(small_map());
  newer[8] = 9;
  expect_input_error([&] { static_cast<void>(parse_map(newer, "b.map")); },
                     {"b.map", "version 9", "expected 1"});
  std::string damaged = map_bytes(small_map());
  damaged[40] = static_cast<char>(damaged[40] ^ 1);
  expect_input_error([&] { static_cast<void>(parse_map(damaged, "c.map")); }, {"c.map", "is damaged"});
  expect_input_error([&] { static_cast<void>(read_map(folder.path() / "none")); },
                     {"none", "cannot be read"});
}

}  // namespace
}  // namespace stillpoint::bench
