// SPDX-License-Identifier: BSD-3-Clause
// The virtual clock. Pictures of the sliding plane come every 33.3 ms.
#include <algorithm>

#include <gtest/gtest.h>

#include "core/pipeline/board_cores.h"
#include "core/pipeline/runner.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/sliding_plane.h"
#include "tests/support/visual_config.h"

namespace stillpoint {
namespace {

constexpr int kPictures = 40;

BoardModel board_of(double tracking_ms, double detection_ms, double optimization_ms, int cores) {
  return {.cores = cores,
          .tracking = {.fixed_ms = tracking_ms},
          .detection = {.fixed_ms = detection_ms},
          .optimization = {.fixed_ms = optimization_ms}};
}

/// What came of a run on a board.
struct BoardResult {
  RunSummary summary;
  std::vector<Eigen::Vector3d> positions;
};

BoardResult run(const BoardModel& board, double speed = 1.0) {
  const SlidingPlane plane(kPictures);
  BoardResult result;
  const RunControl control{
      .on_update = [&](const OdometryUpdate& update) { result.positions.push_back(update.T_w_c.p); },
      .on_picture = {},
      .stop_requested = {}};
  result.summary = run_on_board(plane.input(), visual_config(), control, {.board = board, .speed = speed});
  return result;
}

TEST(BoardCores, GiveWorkToTheCoreThatIsFreeFirst) {
  using std::chrono::nanoseconds;
  BoardCores cores(2);
  EXPECT_EQ(cores.occupy(nanoseconds(0), nanoseconds(10)), nanoseconds(10));
  EXPECT_EQ(cores.occupy(nanoseconds(0), nanoseconds(4)), nanoseconds(4));    // the other core
  EXPECT_EQ(cores.occupy(nanoseconds(1), nanoseconds(5)), nanoseconds(9));    // free at 4
  EXPECT_EQ(cores.occupy(nanoseconds(20), nanoseconds(1)), nanoseconds(21));  // not before it is ready
}

TEST(RunOnBoard, WithoutCostsEqualsSequentialToTheBit) {
  const SlidingPlane plane(kPictures);
  std::vector<Eigen::Vector3d> sequential;
  static_cast<void>(run_sequential(
      plane.input(), visual_config(),
      {.on_update = [&](const OdometryUpdate& update) { sequential.push_back(update.T_w_c.p); },
       .on_picture = {},
       .stop_requested = {}}));
  EXPECT_EQ(run(board_of(0.0, 0.0, 0.0, 3)).positions, sequential);
}

TEST(RunOnBoard, TellsHowLateEachPoseIs) {
  const RunSummary summary = run(board_of(10.0, 0.0, 20.0, 2)).summary;
  EXPECT_EQ(summary.realtime->dropped, 0);
  ASSERT_EQ(summary.realtime->latencies_ms.size(), static_cast<std::size_t>(kPictures));
  for (const double latency : summary.realtime->latencies_ms) EXPECT_NEAR(latency, 30.0, 1e-3);
}

TEST(RunOnBoard, DropsWhatASlowTrackerCannotTake) {
  const BoardResult result = run(board_of(50.0, 0.0, 0.0, 2));
  // The last picture comes after 1.3 s; until then a picture begins every 50 ms: 27 with the one at 0, and at
  // most two that still wait.
  EXPECT_GE(result.positions.size(), 27u);
  EXPECT_LE(result.positions.size(), 29u);
  EXPECT_EQ(result.positions.size() + static_cast<std::size_t>(result.summary.realtime->dropped),
            static_cast<std::size_t>(kPictures));
}

TEST(RunOnBoard, GivesTheSameBitsEachTimeWhereCostsAreFixed) {
  const BoardModel slow = board_of(25.0, 40.0, 60.0, 2);
  const BoardResult first = run(slow);
  EXPECT_GT(first.summary.realtime->dropped, 0);
  EXPECT_EQ(first.positions, run(slow).positions);
}

TEST(RunOnBoard, NeedsTwoCoresForWhatTwoStagesDoAtATime) {
  // 20 + 20 ms: on one core longer than the 33.3 ms between pictures, on two not.
  EXPECT_GT(run(board_of(20.0, 0.0, 20.0, 1)).summary.realtime->dropped, 0);
  EXPECT_EQ(run(board_of(20.0, 0.0, 20.0, 2)).summary.realtime->dropped, 0);
}

TEST(RunOnBoard, TakesNoBoxesThatComeTooLate) {
  OdometryConfig config = visual_config();
  const SlidingPlane plane(kPictures);
  config.detector.kind = DetectorKind::kRecorded;
  const RunSummary summary =
      run_on_board(plane.input(), config, {}, {.board = board_of(1.0, 500.0, 1.0, 3), .speed = 1.0});
  EXPECT_GT(summary.realtime->late_detections, kPictures / 2);
  EXPECT_EQ(summary.realtime->dropped, 0);  // nobody waits for them
}

TEST(RunOnBoard, RefusesAClockThatStands) {
  expect_input_error([] { static_cast<void>(run(board_of(0.0, 0.0, 0.0, 1), 0.0)); },
                     {"--speed", "larger than 0"});
}

}  // namespace
}  // namespace stillpoint
