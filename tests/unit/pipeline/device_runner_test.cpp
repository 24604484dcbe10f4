// SPDX-License-Identifier: BSD-3-Clause
// Simulated target devices. Frame interval of the sliding plane: 33.3 ms.
#include <algorithm>

#include <gtest/gtest.h>

#include "core/pipeline/runners/pacing.h"
#include "core/pipeline/runners/runner.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/simulated/sliding_plane.h"
#include "tests/support/simulated/visual_config.h"

namespace stillpoint {
namespace {

constexpr int kFrames = 40;

DeviceModel device_of(double tracking_ms, double detection_ms, double optimization_ms, int cores) {
  return {.cores = cores,
          .tracking = {.fixed_ms = tracking_ms},
          .detection = {.fixed_ms = detection_ms},
          .optimization = {.fixed_ms = optimization_ms}};
}

/// Result of a run on a device.
struct DeviceResult {
  RunSummary summary;
  std::vector<Eigen::Vector3d> positions;
};

DeviceResult run(const DeviceModel& device, double speed = 1.0) {
  const SlidingPlane plane(kFrames);
  DeviceResult result;
  const RunControl control{
      .on_frame = {[&](const FrameReport& report) { result.positions.push_back(report.update.T_w_c.p); }}};
  result.summary = run_on_device(plane.input(), visual_config(), control, {.device = device, .speed = speed});
  return result;
}

TEST(DeviceCores, AssignJobsToTheCoreThatIsFreeFirst) {
  using std::chrono::nanoseconds;
  DeviceCores cores(2);
  EXPECT_EQ(cores.occupy(nanoseconds(0), nanoseconds(10)), nanoseconds(10));
  EXPECT_EQ(cores.occupy(nanoseconds(0), nanoseconds(4)), nanoseconds(4));    // the other core
  EXPECT_EQ(cores.occupy(nanoseconds(1), nanoseconds(5)), nanoseconds(9));    // free at 4
  EXPECT_EQ(cores.occupy(nanoseconds(20), nanoseconds(1)), nanoseconds(21));  // not before the job is ready
}

TEST(RunOnDevice, WithoutCostsIsBitEqualToSequential) {
  const SlidingPlane plane(kFrames);
  std::vector<Eigen::Vector3d> sequential;
  static_cast<void>(run_sequential(
      plane.input(), visual_config(),
      {.on_frame = {[&](const FrameReport& report) { sequential.push_back(report.update.T_w_c.p); }}}));
  EXPECT_EQ(run(device_of(0.0, 0.0, 0.0, 3)).positions, sequential);
}

TEST(RunOnDevice, ReportsTheLatencyOfEachPose) {
  const RunSummary summary = run(device_of(10.0, 0.0, 20.0, 2)).summary;
  EXPECT_EQ(summary.realtime->dropped, 0);
  ASSERT_EQ(summary.realtime->latencies_ms.size(), static_cast<std::size_t>(kFrames));
  for (const double latency : summary.realtime->latencies_ms) EXPECT_NEAR(latency, 30.0, 1e-3);
}

TEST(RunOnDevice, DropsFramesIfTheTrackerIsTooSlow) {
  const DeviceResult result = run(device_of(50.0, 0.0, 0.0, 2));
  // The last frame arrives at 1.3 s; until then one frame starts every 50 ms: 27 including the one at 0, and
  // at most two frames are still queued.
  EXPECT_GE(result.positions.size(), 27u);
  EXPECT_LE(result.positions.size(), 29u);
  EXPECT_EQ(result.positions.size() + static_cast<std::size_t>(result.summary.realtime->dropped),
            static_cast<std::size_t>(kFrames));
}

TEST(RunOnDevice, IsDeterministicWithFixedCosts) {
  const DeviceModel slow = device_of(25.0, 40.0, 60.0, 2);
  const DeviceResult first = run(slow);
  EXPECT_GT(first.summary.realtime->dropped, 0);
  EXPECT_EQ(first.positions, run(slow).positions);
}

TEST(RunOnDevice, NeedsTwoCoresForConcurrentStages) {
  // 20 + 20 ms: longer than the frame interval on one core, but not on two.
  EXPECT_GT(run(device_of(20.0, 0.0, 20.0, 1)).summary.realtime->dropped, 0);
  EXPECT_EQ(run(device_of(20.0, 0.0, 20.0, 2)).summary.realtime->dropped, 0);
}

TEST(RunOnDevice, IgnoresLateDetections) {
  OdometryConfig config = visual_config();
  const SlidingPlane plane(kFrames);
  config.detector.kind = DetectorKind::kRecorded;
  const RunSummary summary =
      run_on_device(plane.input(), config, {}, {.device = device_of(1.0, 500.0, 1.0, 3), .speed = 1.0});
  EXPECT_GT(summary.realtime->late_detections, kFrames / 2);
  EXPECT_EQ(summary.realtime->dropped, 0);  // the wait for detections is limited
}

TEST(RunOnDevice, RejectsASpeedOfZero) {
  expect_input_error([] { static_cast<void>(run(device_of(0.0, 0.0, 0.0, 1), 0.0)); },
                     {"--speed", "larger than 0"});
}

}  // namespace
}  // namespace stillpoint
