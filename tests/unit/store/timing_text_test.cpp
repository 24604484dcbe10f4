// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/run_csv.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint::bench {
namespace {

TEST(TimingText, RoundTripPreservesTheSamples) {
  const std::vector<TimingSample> samples = {{0, "feature_tracking", 3'360'000, 1}, {7, "own module", 5, 2}};
  const std::string text = timing_text(samples);
  EXPECT_EQ(text, "frame,module,ns,calls\n0,feature_tracking,3360000,1\n7,own module,5,2\n");
  const std::vector<TimingSample> read = parse_timings(text, "test");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[1].frame, 7);
  EXPECT_EQ(read[1].module, "own module");
  EXPECT_EQ(read[1].ns, 5);
  EXPECT_EQ(read[1].calls, 2);
}

TEST(TimingText, ErrorsNameTheLine) {
  expect_input_error(
      [] { static_cast<void>(parse_timings("frame,module,ns,calls\n0,a,1,1\n1,a,x,1\n", "f.csv")); },
      {"f.csv:3: ", "\"x\" is not an integer"});
  expect_input_error([] { static_cast<void>(parse_timings("0,a,1,1\n", "f.csv")); },
                     {"f.csv:1: ", "does not begin"});
}

}  // namespace
}  // namespace stillpoint::bench
