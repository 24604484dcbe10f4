// SPDX-License-Identifier: BSD-3-Clause
// Tracking, optimisation and the ways between them ask for no memory once they have held as much as they
// need.
#include <gtest/gtest.h>

#include <algorithm>

#include "bench/config/config_file.h"
#include "bench/profile/allocation_counter.h"
#include "core/pipeline/runner.h"
#include "tests/support/sliding_plane.h"

namespace stillpoint {
namespace {

constexpr std::size_t kOneWay = 15;
constexpr std::size_t kRound = 2 * kOneWay;
constexpr std::size_t kPictures = 8 * kRound;

class RunnerThatIs : public testing::TestWithParam<decltype(&run_sequential)> {};

/// The camera slides to and fro before the wall; nobody looks for objects, pictures are there before.
TEST_P(RunnerThatIs, AllocatesNothingOnceItHasHeldAsMuch) {
  const SlidingPlane plane(kPictures);
  std::vector<Frame> pictures;
  for (std::size_t i = 0; i <= kOneWay; ++i) pictures.push_back(plane.picture(i));
  SensorInput input = plane.input();
  input.load_frame = [&](std::size_t index) {
    const std::size_t step = index % kRound;
    Frame frame = pictures[std::min(step, kRound - step)];
    frame.id = static_cast<std::int64_t>(index);
    frame.t = input.frame_times[index];
    return frame;
  };
  const OdometryConfig config = load_config(
      {.base = "stillpoint",
       .variant = "vo",
       .settings = {"detector.kind=none", "pipeline.feedback_lag=1", "frontend.min_distance_px=10"}});
  std::vector<std::size_t> counts;
  counts.reserve(kPictures);
  int lost = 0;
  const RunControl control{.on_update =
                               [&](const OdometryUpdate& update) {
                                 counts.push_back(allocation_count());
                                 lost += update.status != OdometryStatus::kTracking;
                               },
                           .on_picture = {},
                           .stop_requested = {}};
  static_cast<void>(GetParam()(input, config, control));
  ASSERT_EQ(counts.size(), kPictures);
  EXPECT_EQ(lost, 0);
  // The last two rounds, but for the end of the run, when threads close.
  EXPECT_EQ(counts[kPictures - 8] - counts[kPictures - 2 * kRound], 0u);
  EXPECT_GT(counts[kRound] - counts[0], 100u);  // the counter counts
}

INSTANTIATE_TEST_SUITE_P(Modes, RunnerThatIs, testing::Values(&run_sequential, &run_pipelined),
                         [](const auto& mode) { return mode.index == 0 ? "Sequential" : "Pipelined"; });

}  // namespace
}  // namespace stillpoint
