// SPDX-License-Identifier: BSD-3-Clause
// Tracking, optimization and the channels between them are allocation-free in the steady state.
#include <gtest/gtest.h>

#include <algorithm>

#include "bench/config/config_file.h"
#include "bench/profile/meters/allocation_counter.h"
#include "core/pipeline/runners/runner.h"
#include "tests/support/simulated/sliding_plane.h"

namespace stillpoint {
namespace {

constexpr std::size_t kHalfRound = 15;
constexpr std::size_t kRound = 2 * kHalfRound;
constexpr std::size_t kFrames = 8 * kRound;

class RunnerIn : public testing::TestWithParam<decltype(&run_sequential)> {};

/// The camera moves back and forth parallel to the plane; without detector, and with preloaded images.
TEST_P(RunnerIn, IsAllocationFreeInTheSteadyState) {
  const SlidingPlane plane(kFrames);
  std::vector<Frame> frames;
  for (std::size_t i = 0; i <= kHalfRound; ++i) frames.push_back(plane.frame(i));
  SensorInput input = plane.input();
  input.load_frame = [&](std::size_t index) {
    const std::size_t step = index % kRound;
    Frame frame = frames[std::min(step, kRound - step)];
    frame.id = static_cast<std::int64_t>(index);
    frame.t = input.frame_times[index];
    return frame;
  };
  const OdometryConfig config =
      bench::load_config({.base = "stillpoint",
                          .variant = "vo",
                          .settings = {"detector.kind=none", "pipeline.feedback_lag=1",
                                       "frontend.min_distance_px=10", "pipeline.perturbation_seed=1"}});
  std::vector<std::size_t> counts;
  counts.reserve(kFrames);
  int lost = 0;
  const RunControl control{.on_update =
                               [&](const OdometryUpdate& update) {
                                 counts.push_back(bench::allocation_count());
                                 lost += !is_located(update.status);
                               },
                           .on_frame = {},
                           .stop_requested = {}};
  static_cast<void>(GetParam()(input, config, control));
  ASSERT_EQ(counts.size(), kFrames);
  EXPECT_EQ(lost, 0);
  // The last two rounds, without the end of the run, where threads finish.
  EXPECT_EQ(counts[kFrames - 8] - counts[kFrames - 2 * kRound], 0u);
  EXPECT_GT(counts[kRound] - counts[0], 100u);  // the counter works
}

INSTANTIATE_TEST_SUITE_P(Modes, RunnerIn, testing::Values(&run_sequential, &run_pipelined),
                         [](const auto& mode) { return mode.index == 0 ? "Sequential" : "Pipelined"; });

}  // namespace
}  // namespace stillpoint
