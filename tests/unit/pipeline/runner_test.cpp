// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runner.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/sliding_plane.h"
#include "tests/support/visual_config.h"

namespace stillpoint {
namespace {

constexpr int kPictures = 40;

/// Everything that a run says of positions.
struct Path {
  std::vector<Eigen::Vector3d> positions;
  RunControl control() {
    return {.on_update = [this](const OdometryUpdate& update) { positions.push_back(update.T_w_c.p); },
            .on_picture = {},
            .stop_requested = {}};
  }
};

TEST(Runner, SequentialFollowsTheSlide) {
  const SlidingPlane plane(kPictures);
  Path path;
  const RunSummary summary = run_sequential(plane.input(), visual_config(), path.control());
  EXPECT_EQ(summary.frames, kPictures);
  ASSERT_EQ(path.positions.size(), kPictures);
  EXPECT_NEAR(path.positions.back().x(), SlidingPlane::moved_m(kPictures - 1), 0.01);
  EXPECT_NEAR(path.positions.back().z(), 0.0, 0.01);
}

TEST(Runner, PipelinedEqualsSequentialToTheBitAtEachLag) {
  const SlidingPlane plane(kPictures);
  for (const int lag : {0, 1, 3}) {
    Path one_thread, three_threads;
    static_cast<void>(run_sequential(plane.input(), visual_config(lag), one_thread.control()));
    static_cast<void>(run_pipelined(plane.input(), visual_config(lag), three_threads.control()));
    EXPECT_EQ(one_thread.positions, three_threads.positions) << "lag " << lag;
  }
}

TEST(Runner, RealtimeAnswersEveryPictureThatItDidNotDrop) {
  const SlidingPlane plane(kPictures);
  Path path;
  const RunSummary summary = run_realtime(plane.input(), visual_config(), path.control(), 20.0);
  ASSERT_TRUE(summary.realtime.has_value());
  EXPECT_EQ(path.positions.size() + static_cast<std::size_t>(summary.realtime->dropped), kPictures);
  EXPECT_EQ(summary.realtime->latencies_ms.size(), path.positions.size());
  EXPECT_NEAR(summary.realtime->deadline_ms, 33.333 / 20.0, 0.001);
}

TEST(Runner, EveryRunnerSkipsAndNamesAPictureThatCannotBeRead) {
  const SlidingPlane plane(kPictures);
  SensorInput input = plane.input();
  input.load_frame = [&plane](std::size_t index) {
    if (index == 7) throw InputError("seventh.png", "is truncated");
    return plane.picture(index);
  };
  for (const auto& run : {run_sequential, run_pipelined}) {
    Path path;
    const RunSummary summary = run(input, visual_config(), path.control());
    ASSERT_EQ(summary.skipped.size(), 1u);
    EXPECT_EQ(summary.skipped[0].index, 7u);
    EXPECT_EQ(path.positions.size(), kPictures - 1u);
  }
}

TEST(Runner, StopsCleanlyWhenAsked) {
  const SlidingPlane plane(kPictures);
  for (const auto& run : {run_sequential, run_pipelined}) {
    Path path;
    RunControl control = path.control();
    control.stop_requested = [asked = 0]() mutable { return ++asked > 10; };
    const RunSummary summary = run(plane.input(), visual_config(), control);
    EXPECT_TRUE(summary.interrupted);
    EXPECT_EQ(path.positions.size(), 10u);
  }
}

TEST(Runner, AFaultOnAnyThreadReachesTheCaller) {
  const SlidingPlane plane(kPictures);
  SensorInput input = plane.input();
  input.load_frame = [&plane](std::size_t index) -> Frame {
    if (index == 5) throw std::runtime_error("camera on fire");
    return plane.picture(index);
  };
  Path path;
  EXPECT_THROW(static_cast<void>(run_pipelined(input, visual_config(), path.control())), std::runtime_error);
  EXPECT_THROW(static_cast<void>(run_realtime(input, visual_config(), path.control(), 20.0)),
               std::runtime_error);
  const RunControl failing_sink{
      .on_update = [](const OdometryUpdate&) { throw std::runtime_error("disk on fire"); },
      .on_picture = {},
      .stop_requested = {}};
  EXPECT_THROW(static_cast<void>(run_pipelined(plane.input(), visual_config(), failing_sink)),
               std::runtime_error);
}

TEST(Runner, RefusesAClockThatStands) {
  const SlidingPlane plane(1);
  expect_input_error([&] { static_cast<void>(run_realtime(plane.input(), visual_config(), {}, 0.0)); },
                     {"--speed", "larger than 0"});
}

}  // namespace
}  // namespace stillpoint
