// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runners/runner.h"

#include <gtest/gtest.h>

#include <set>

#include "core/base/error.h"
#include "core/detector/opencv_threads.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/simulated/sliding_plane.h"
#include "tests/support/simulated/visual_config.h"

namespace stillpoint {
namespace {

constexpr int kFrames = 40;

/// Records the estimated positions of a run.
struct PositionRecorder {
  std::vector<Eigen::Vector3d> positions;
  RunControl control() {
    return {.on_frame = {[this](const FrameReport& report) { positions.push_back(report.update.T_w_c.p); }}};
  }
};

TEST(Runner, SequentialEstimatesTheMotion) {
  const SlidingPlane plane(kFrames);
  PositionRecorder recorder;
  const RunSummary summary = run_sequential(plane.input(), visual_config(), recorder.control());
  EXPECT_EQ(summary.frames, kFrames);
  ASSERT_EQ(recorder.positions.size(), kFrames);
  EXPECT_NEAR(recorder.positions.back().x(), SlidingPlane::camera_x_m(kFrames - 1), 0.01);
  EXPECT_NEAR(recorder.positions.back().z(), 0.0, 0.01);
}

TEST(Runner, PipelinedIsBitEqualToSequentialForEachLag) {
  const SlidingPlane plane(kFrames);
  for (const int lag : {0, 1, 3}) {
    PositionRecorder one_thread, three_threads;
    static_cast<void>(run_sequential(plane.input(), visual_config(lag), one_thread.control()));
    static_cast<void>(run_pipelined(plane.input(), visual_config(lag), three_threads.control()));
    EXPECT_EQ(one_thread.positions, three_threads.positions) << "lag " << lag;
  }
}

TEST(Runner, RealtimeReportsAPoseForEachFrameThatWasNotDropped) {
  const SlidingPlane plane(kFrames);
  PositionRecorder recorder;
  const RunSummary summary = run_realtime(plane.input(), visual_config(), recorder.control(), 20.0);
  ASSERT_TRUE(summary.realtime.has_value());
  EXPECT_EQ(recorder.positions.size() + static_cast<std::size_t>(summary.realtime->dropped), kFrames);
  EXPECT_EQ(summary.realtime->latencies_ms.size(), recorder.positions.size());
  EXPECT_NEAR(summary.realtime->deadline_ms, 33.333 / 20.0, 0.001);
}

/// Numbers of OpenCV threads that a run shows if the process has `before` and the config asks for `wanted`.
std::set<int> opencv_threads_in(decltype(&run_sequential) run, int before, int wanted) {
  const SlidingPlane plane(kFrames);
  const ScopedOpencvThreads of_process(before);
  OdometryConfig config = visual_config();
  config.detector.threads = wanted;
  std::set<int> seen;
  static_cast<void>(run(plane.input(), config,
                        {.on_frame = {[&](const FrameReport&) { seen.insert(cv::getNumThreads()); }}}));
  EXPECT_EQ(cv::getNumThreads(), before);
  return seen;
}

TEST(Runner, KeepsTheNumberOfOpencvThreadsOfTheConfigDuringTheWholeRun) {
  for (const auto run : {&run_sequential, &run_pipelined}) {
    EXPECT_EQ(opencv_threads_in(run, 2, 1), std::set{1});
    EXPECT_EQ(opencv_threads_in(run, 1, 2), std::set{2});
  }
}

TEST(Runner, SkipsAndReportsFramesThatCannotBeRead) {
  const SlidingPlane plane(kFrames);
  SensorInput input = plane.input();
  input.load_frame = [&plane](std::size_t index) {
    if (index == 7) throw InputError("seventh.png", "is truncated");
    return plane.frame(index);
  };
  for (const auto& run : {run_sequential, run_pipelined}) {
    PositionRecorder recorder;
    const RunSummary summary = run(input, visual_config(), recorder.control());
    ASSERT_EQ(summary.skipped.size(), 1u);
    EXPECT_EQ(summary.skipped[0].index, 7u);
    EXPECT_EQ(recorder.positions.size(), kFrames - 1u);
  }
}

TEST(Runner, SkipsFramesThatArriveAfterLaterOnesOrTwice) {
  const SlidingPlane plane(kFrames);
  SensorInput input = plane.input();
  std::vector<FrameArrival> arrivals;
  for (std::size_t i = 0; i < kFrames; ++i) arrivals.push_back({i, input.frame_times[i]});
  std::swap(arrivals[5].index, arrivals[6].index);
  arrivals[6].t = arrivals[5].t = input.frame_times[6];
  arrivals.insert(arrivals.begin() + 9, {8, input.frame_times[9]});
  input.arrivals = arrivals;
  for (const auto& run : {run_sequential, run_pipelined}) {
    PositionRecorder recorder;
    const RunSummary summary = run(input, visual_config(), recorder.control());
    ASSERT_EQ(summary.skipped.size(), 1U);
    EXPECT_EQ(summary.skipped[0].index, 5U);
    EXPECT_EQ(summary.frames, kFrames);
    EXPECT_EQ(recorder.positions.size(), kFrames - 1U);
  }
  PositionRecorder recorder;
  const RunSummary summary = run_realtime(input, visual_config(), recorder.control(), 1.0);
  EXPECT_EQ(summary.skipped.size(), 1U);
  arrivals.front().t = after(input.frame_times[0], -1.0);
  EXPECT_THROW(static_cast<void>(run_sequential(input, visual_config(), {})), InputError);
}

TEST(Runner, StopsOnRequest) {
  const SlidingPlane plane(kFrames);
  for (const auto& run : {run_sequential, run_pipelined}) {
    PositionRecorder recorder;
    RunControl control = recorder.control();
    control.stop_requested = [polls = 0]() mutable { return ++polls > 10; };
    const RunSummary summary = run(plane.input(), visual_config(), control);
    EXPECT_TRUE(summary.interrupted);
    EXPECT_EQ(recorder.positions.size(), 10u);
  }
}

TEST(Runner, PropagatesExceptionsFromAnyThread) {
  const SlidingPlane plane(kFrames);
  SensorInput input = plane.input();
  input.load_frame = [&plane](std::size_t index) -> Frame {
    if (index == 5) throw std::runtime_error("camera error");
    return plane.frame(index);
  };
  PositionRecorder recorder;
  EXPECT_THROW(static_cast<void>(run_pipelined(input, visual_config(), recorder.control())),
               std::runtime_error);
  EXPECT_THROW(static_cast<void>(run_realtime(input, visual_config(), recorder.control(), 20.0)),
               std::runtime_error);
  const RunControl failing_sink{
      .on_frame = {[](const FrameReport&) { throw std::runtime_error("disk error"); }}};
  EXPECT_THROW(static_cast<void>(run_pipelined(plane.input(), visual_config(), failing_sink)),
               std::runtime_error);
}

TEST(Runner, RejectsASpeedOfZero) {
  const SlidingPlane plane(1);
  expect_input_error([&] { static_cast<void>(run_realtime(plane.input(), visual_config(), {}, 0.0)); },
                     {"--speed", "larger than 0"});
}

}  // namespace
}  // namespace stillpoint
