// SPDX-License-Identifier: BSD-3-Clause
/// Runs the fuzz target on generated seeds and random mutations of them, with a fixed random seed.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "eval/io/matrix_files.h"
#include "eval/io/openloris_file.h"
#include "eval/io/trajectory_file.h"
#include "tests/support/simulated/smooth_path.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace stillpoint::eval {
namespace {

int run_target(const std::string& text) {
  return LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

std::vector<std::string> seeds() {
  const Trajectory path = test::smooth_path(8, 0.1, 1.5e9);
  const KittiTexts kitti = format_kitti(path);
  return {"",
          "\n\r\n#\n",
          std::string(3, '\0'),
          format_tum(path),
          format_euroc(path),
          kitti.poses + kitti.times,
          format_openloris({.scene = "home", .frame = "base_link", .sequences = {{1, path}, {2, path}}}),
          "1e300 1e300 -1e300 1e308 1 0 0 1\n",
          "9223372036.854775807 0 0 0 0 0 0 1\n9223372036.9 0 0 0 0 0 0 1\n",
          "-9e9 0 0 0 0 0 0 1\n9e9 0 0 0 0 0 0 1\n",
          "1 0 0 0 5e-324 0 0 5e-324\n",
          "seq:99999999999999999999\n",
          "seq: 1\n" + std::string(10000, ' ') + "1"};
}

/// One mutation: a changed byte, a removed or duplicated substring, or a substring of another seed.
std::string mutated(std::string text, const std::string& other, std::mt19937& random) {
  const auto below = [&random](std::size_t n) { return n == 0 ? 0 : random() % n; };
  const std::size_t at = below(text.size());
  const std::size_t length = below(std::min<std::size_t>(text.size() - at, 40));
  switch (below(4)) {
    case 0:
      if (!text.empty()) text[at] = static_cast<char>(below(256));
      return text;
    case 1:
      return text.erase(at, length);
    case 2:
      return text.insert(at, text.substr(at, length));
    default:
      return text.insert(at, other.substr(below(other.size()), length));
  }
}

TEST(TrajectoryText, SeedsAreParsedOrRejected) {
  for (const std::string& seed : seeds()) EXPECT_EQ(run_target(seed), 0);
}

TEST(TrajectoryText, MutatedSeedsAreParsedOrRejected) {
  std::mt19937 random(1);
  const std::vector<std::string> all = seeds();
  for (int round = 0; round < 300; ++round) {
    for (const std::string& seed : all) {
      std::string text = seed;
      for (int i = 0; i < 1 + round % 4; ++i) text = mutated(text, all[random() % all.size()], random);
      ASSERT_EQ(run_target(text), 0);
    }
  }
}

}  // namespace
}  // namespace stillpoint::eval
