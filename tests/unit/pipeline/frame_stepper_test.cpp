// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/frame_stepper.h"

#include <gtest/gtest.h>

#include "core/pipeline/runners/sequence_feed.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/simulated/sliding_plane.h"
#include "tests/support/simulated/visual_config.h"

namespace stillpoint {
namespace {

TEST(MakeDetector, DisablesTheDetectorIfTheMaskIsOff) {
  const SlidingPlane plane(1);
  OdometryConfig config = visual_config();
  config.dynamic.mask = DynamicMask::kOff;
  EXPECT_EQ(make_detector(plane.input(), config)->description(), "none");
}

TEST(MakeDetector, ASimulatedDetectorRequiresTrueBoxes) {
  const SlidingPlane plane(1);
  OdometryConfig config = visual_config();
  config.detector.kind = DetectorKind::kSimulated;
  expect_input_error([&] { static_cast<void>(make_detector(plane.input(), config)); },
                     {"detector.kind", "true boxes"});
}

TEST(FrameStepper, InertialOdometryRequiresAnImu) {
  const SlidingPlane plane(1);
  expect_input_error([&] { FrameStepper(OdometryConfig{}, plane.input().rig, LoopExecution::kInline); },
                     {"imu.enabled", "--variant vo"});
}

TEST(FrameStepper, AMapRequiresLoopClosure) {
  const SlidingPlane plane(1);
  FrameStepper stepper(visual_config(), plane.input().rig, LoopExecution::kInline);
  expect_input_error([&] { stepper.use_map({}); }, {"loop.enabled", "is off"});
  EXPECT_FALSE(stepper.finish_loops().has_value());
}

TEST(WindowRate, AdmitsEveryThirdFrameAt10Of30Hz) {
  WindowRate rate(10.0);
  int admitted = 0;
  for (int i = 0; i < 300; ++i) {
    const Timestamp t{i * 33'333'333LL};
    if (!rate.is_due(t)) continue;
    rate.accept(t);
    ++admitted;
  }
  EXPECT_EQ(admitted, 100);  // three intervals are 1 ns less than 0.1 s, within the tolerance
}

ImuSample sample_at(double t_s) { return {.t = from_seconds(t_s)}; }

std::vector<double> read(ImuQueue& queue, ImuQueue::Reader reader, double end_s) {
  std::vector<double> times;
  queue.read_until(reader, from_seconds(end_s),
                   [&](const ImuSample& sample) { times.push_back(seconds_between(Timestamp{}, sample.t)); });
  return times;
}

TEST(ImuQueue, EachReaderHasItsOwnPosition) {
  using Reader = ImuQueue::Reader;
  using Times = std::vector<double>;
  ImuQueue queue;
  for (const double t : {1.0, 2.0, 3.0}) queue.add(sample_at(t));
  EXPECT_EQ(read(queue, Reader::kTracking, 2.0), (Times{1.0, 2.0}));
  EXPECT_EQ(read(queue, Reader::kOptimization, 1.5), (Times{1.0}));
  EXPECT_EQ(read(queue, Reader::kPrediction, 9.0), (Times{1.0, 2.0, 3.0}));
  queue.add(sample_at(4.0));
  EXPECT_EQ(read(queue, Reader::kOptimization, 3.0), (Times{2.0, 3.0}));
  EXPECT_EQ(read(queue, Reader::kTracking, 9.0), (Times{3.0, 4.0}));
  EXPECT_EQ(read(queue, Reader::kPrediction, 9.0), (Times{4.0}));
  EXPECT_EQ(read(queue, Reader::kPrediction, 9.0), Times{});
}

TEST(ImuQueue, ASampleOutOfOrderIsReadAfterTheOneBeforeIt) {
  ImuQueue queue;
  for (const double t : {1.0, 3.0, 2.0}) queue.add(sample_at(t));
  EXPECT_EQ(read(queue, ImuQueue::Reader::kTracking, 2.5), std::vector<double>{1.0});
  EXPECT_EQ(read(queue, ImuQueue::Reader::kTracking, 3.0), (std::vector<double>{3.0, 2.0}));
}

TEST(ImuQueue, DoesNotWaitForAReceivedSampleOrAfterTheLastOne) {
  ImuQueue queue;
  queue.add(sample_at(1.0));
  queue.wait_until(from_seconds(1.0));
  queue.finish();
  queue.wait_until(from_seconds(2.0));
}

}  // namespace
}  // namespace stillpoint
