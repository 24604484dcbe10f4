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

/// The camera moves back and forth parallel to the plane; without detector, and with preloaded images.
class BackAndForth {
 public:
  BackAndForth() {
    for (std::size_t i = 0; i <= kHalfRound; ++i) frames_.push_back(plane_.frame(i));
  }

  [[nodiscard]] SensorInput input() const {
    SensorInput input = plane_.input();
    input.load_frame = [this, times = input.frame_times](std::size_t index) {
      const std::size_t step = index % kRound;
      Frame frame = frames_[std::min(step, kRound - step)];
      frame.id = static_cast<std::int64_t>(index);
      frame.t = times[index];
      return frame;
    };
    return input;
  }

 private:
  SlidingPlane plane_{kFrames};
  std::vector<Frame> frames_;
};

OdometryConfig config_with(std::vector<std::string> settings) {
  for (const char* setting : {"detector.kind=none", "pipeline.feedback_lag=1", "frontend.min_distance_px=10",
                              "pipeline.perturbation_seed=1"})
    settings.emplace_back(setting);
  return bench::load_config({.base = "stillpoint", .variant = "vo", .settings = settings});
}

class RunnerIn : public testing::TestWithParam<decltype(&run_sequential)> {};

TEST_P(RunnerIn, IsAllocationFreeInTheSteadyState) {
  const BackAndForth motion;
  std::vector<std::size_t> counts;
  counts.reserve(kFrames);
  int lost = 0;
  const RunControl control{.on_frame = {[&](const FrameReport& report) {
                             counts.push_back(bench::allocation_count());
                             lost += !is_located(report.update.status);
                           }}};
  static_cast<void>(GetParam()(motion.input(), config_with({}), control));
  ASSERT_EQ(counts.size(), kFrames);
  EXPECT_EQ(lost, 0);
  // The last two rounds, without the end of the run, where threads finish.
  EXPECT_EQ(counts[kFrames - 8] - counts[kFrames - 2 * kRound], 0u);
  EXPECT_GT(counts[kRound] - counts[0], 100u);  // the counter works
}

/// The thread of the loop closure allocates: the map grows.
TEST(PipelinedRunner, TrackingAndOptimizationAreAllocationFreeBesideLoopClosure) {
  const BackAndForth motion;
  std::vector<std::size_t> tracking, optimization;
  tracking.reserve(kFrames);
  optimization.reserve(kFrames);
  std::size_t corrected = 0;
  const RunControl control{.on_frame = {[&](const FrameReport& report) {
                             tracking.push_back(bench::allocation_count_of("tracking"));
                             optimization.push_back(bench::allocation_count_of("optimization"));
                             corrected += !report.update.T_m_w.p.isZero(0.0);
                           }}};
  OdometryConfig config =
      config_with({"loop.enabled=true", "loop.min_gap_s=0.3", "loop.min_translation_m=0.05",
                   "loop.min_inliers=12", "loop.lag_frames=10"});
  config.loop.min_votes = 5;
  const RunSummary summary = run_pipelined(motion.input(), config, control);
  ASSERT_EQ(tracking.size(), kFrames);
  EXPECT_GT(summary.loops->keyframes.size(), 20u);
  EXPECT_GT(corrected, kFrames / 2);
  for (const std::vector<std::size_t>& counts : {tracking, optimization}) {
    EXPECT_EQ(counts[kFrames - 8] - counts[kFrames - 2 * kRound], 0u);
    EXPECT_GT(counts[kRound], 100u);  // the counter works
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, RunnerIn, testing::Values(&run_sequential, &run_pipelined),
                         [](const auto& mode) { return mode.index == 0 ? "Sequential" : "Pipelined"; });

}  // namespace
}  // namespace stillpoint
