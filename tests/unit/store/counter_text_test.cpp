// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/run_csv.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint::bench {
namespace {

const std::string kHeader =
    "frame,t_ns,status,tracked_features,window_landmarks,depth_landmarks,dynamic_features,solver_iterations,"
    "keyframe,reset\n";

TEST(CounterText, RoundTripPreservesTheCounters) {
  const std::vector<FrameCounters> frames = {{.frame = 3,
                                              .t_ns = 1'341'846'313'592'026'000,
                                              .status = "tracking",
                                              .tracked_features = 130,
                                              .window_landmarks = 90,
                                              .depth_landmarks = 80,
                                              .dynamic_features = 7,
                                              .solver_iterations = 4,
                                              .keyframe = true,
                                              .reset = false}};
  const std::string text = counter_text(frames);
  EXPECT_EQ(text, kHeader + "3,1341846313592026000,tracking,130,90,80,7,4,1,0\n");
  const std::vector<FrameCounters> read = parse_counters(text, "test");
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(counter_text(read), text);
  EXPECT_EQ(read[0].dynamic_features, 7);
  EXPECT_TRUE(read[0].keyframe);
}

TEST(CounterText, ErrorsNameTheLine) {
  expect_input_error([] { static_cast<void>(parse_counters(kHeader + "0,1,lost,1,1,1,x,1,0,0\n", "c.csv")); },
                     {"c.csv:2: ", "\"x\" is not an integer"});
  expect_input_error([] { static_cast<void>(parse_counters("frame\n", "c.csv")); },
                     {"c.csv:1: ", "does not begin"});
}

}  // namespace
}  // namespace stillpoint::bench
