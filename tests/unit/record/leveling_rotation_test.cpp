// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/result_values.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

/// Reads a file with the given text.
std::optional<Eigen::Quaterniond> read(const std::string& text) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "result.json";
  std::ofstream(file) << text;
  return read_leveling_rotation(file);
}

TEST(LevelingRotation, IsReadFromTheResultOfARun) {
  const auto q = read(R"({"leveling_rotation_xyzw": [0.6, 0.0, 0.0, 0.8]})");
  ASSERT_TRUE(q);
  EXPECT_EQ(q->coeffs(), Eigen::Vector4d(0.6, 0.0, 0.0, 0.8));
}

TEST(LevelingRotation, IsAbsentInOtherFiles) { EXPECT_FALSE(read(R"({"schema": 1})")); }

TEST(LevelingRotation, RejectsFilesThatAreNoResultAndValuesThatAreNoRotation) {
  expect_input_error([] { static_cast<void>(read("no json")); }, {"result.json", "not a result file"});
  expect_input_error([] { static_cast<void>(read(R"({"leveling_rotation_xyzw": [1, 0, 0]})")); },
                     {"result.json", "not a result file"});
  expect_input_error([] { static_cast<void>(read(R"({"leveling_rotation_xyzw": [1, 0, 0, 1]})")); },
                     {"result.json", "unit quaternion"});
}

}  // namespace
}  // namespace stillpoint::bench
