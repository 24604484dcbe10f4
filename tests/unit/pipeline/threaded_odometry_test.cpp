// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/threaded_odometry.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <thread>

#include "core/pipeline/odometry.h"
#include "core/pipeline/stages/frame_report.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/simulated/inertial_plane.h"

namespace stillpoint {
namespace {

constexpr int kFrames = 40;
using Positions = std::vector<Eigen::Vector3d>;

/// Records the positions of all updates.
ThreadedOdometryOptions recording(Positions& positions) {
  return {.on_frame = {[&](const FrameReport& report) { positions.push_back(report.update.T_w_c.p); }}};
}

Positions run_single_threaded(const SlidingPlane& plane, const std::vector<ImuSample>& imu,
                              const OdometryConfig& config) {
  Odometry odometry(config, inertial_plane_rig(plane));
  for (const ImuSample& sample : imu) odometry.add_imu(sample);
  Positions positions;
  for (std::size_t i = 0; i < kFrames; ++i) positions.push_back(odometry.track(plane.frame(i)).T_w_c.p);
  return positions;
}

Positions run_on_threads(const SlidingPlane& plane, const std::vector<ImuSample>& imu,
                         const OdometryConfig& config) {
  Positions positions;
  ThreadedOdometry odometry(config, inertial_plane_rig(plane), recording(positions));
  std::jthread sensor([&] {
    for (const ImuSample& sample : imu) odometry.add_imu(sample);
    odometry.finish_imu();
  });
  for (std::size_t i = 0; i < kFrames; ++i) EXPECT_TRUE(odometry.add_frame(plane.frame(i)));
  sensor.join();  // `finish` would not wait for the rest of the samples
  odometry.finish();
  return positions;
}

TEST(ThreadedOdometry, IsBitEqualToOdometryForEachLag) {
  const SlidingPlane plane(kFrames);
  const std::vector<ImuSample> imu = plane_imu(2.0);
  for (const int lag : {0, 1, 3}) {
    const OdometryConfig config = inertial_config(lag);
    EXPECT_EQ(run_on_threads(plane, imu, config), run_single_threaded(plane, imu, config)) << "lag " << lag;
  }
}

/// The tracker, which gets feedback with a lag, and the optimization use samples up to different times.
TEST(ThreadedOdometry, IsBitEqualToOdometryWhileTheTimeOffsetChanges) {
  const SlidingPlane plane(kFrames);
  Random random(5);
  std::vector<ImuSample> imu = plane_imu(2.0);
  for (ImuSample& sample : imu) {
    for (int k = 0; k < 3; ++k) sample.gyro_b[k] += 0.05 * random.normal();
    for (int k = 0; k < 3; ++k) sample.accel_b[k] += 0.2 * random.normal();
  }
  for (const int lag : {0, 1, 3}) {
    OdometryConfig config = inertial_config(lag);
    config.backend.time_offset_model = TimeOffsetModel::kInertial;
    config.backend.prior = PriorModel::kConsistent;
    EXPECT_EQ(run_on_threads(plane, imu, config), run_single_threaded(plane, imu, config)) << "lag " << lag;
  }
}

TEST(ThreadedOdometry, WaitsForTheSamplesOfAFrame) {
  const SlidingPlane plane(1);
  std::promise<void> updated;
  std::atomic<bool> complete = false;
  bool was_complete = false;
  ThreadedOdometry odometry(inertial_config(), inertial_plane_rig(plane),
                            {.on_frame = {[&](const FrameReport&) {
                               was_complete = complete;
                               updated.set_value();
                             }}});
  odometry.add_frame(plane.frame(0));
  const Timestamp needed = after(plane.frame(0).t, 0.02);
  for (Timestamp t = after(needed, -0.1); t < needed; t = after(t, 0.005)) odometry.add_imu(plane_imu_at(t));
  complete = true;
  odometry.add_imu(plane_imu_at(needed));
  updated.get_future().get();
  EXPECT_TRUE(was_complete);
}

TEST(ThreadedOdometry, DoesNotWaitForSamplesAfterTheLastOne) {
  const SlidingPlane plane(3);
  Positions positions;
  ThreadedOdometry odometry(inertial_config(), inertial_plane_rig(plane), recording(positions));
  odometry.finish_imu();
  for (std::size_t i = 0; i < 3; ++i) odometry.add_frame(plane.frame(i));
  odometry.finish();
  EXPECT_EQ(positions.size(), 3u);
}

TEST(ThreadedOdometry, FinishProcessesFramesThatWaitForSamples) {
  const SlidingPlane plane(2);
  Positions positions;
  ThreadedOdometry odometry(inertial_config(), inertial_plane_rig(plane), recording(positions));
  for (std::size_t i = 0; i < 2; ++i) odometry.add_frame(plane.frame(i));
  odometry.finish();
  EXPECT_EQ(positions.size(), 2u);
  EXPECT_FALSE(odometry.add_frame(plane.frame(1)));
}

TEST(ThreadedOdometry, StopDiscardsFramesThatWaitForSamples) {
  const SlidingPlane plane(2);
  Positions positions;
  {
    ThreadedOdometry odometry(inertial_config(), inertial_plane_rig(plane), recording(positions));
    for (std::size_t i = 0; i < 2; ++i) odometry.add_frame(plane.frame(i));
  }
  EXPECT_TRUE(positions.empty());
}

TEST(ThreadedOdometry, StopReleasesABlockedCaller) {
  const SlidingPlane plane(8);
  Positions positions;
  ThreadedOdometry odometry(inertial_config(), inertial_plane_rig(plane), recording(positions));
  std::promise<void> started;
  std::future<bool> kept = std::async(std::launch::async, [&] {
    started.set_value();
    bool all = true;
    for (std::size_t i = 0; i < 8; ++i) all = odometry.add_frame(plane.frame(i)) && all;
    return all;
  });
  started.get_future().get();
  odometry.stop();
  EXPECT_FALSE(kept.get());
  EXPECT_TRUE(positions.empty());
}

TEST(ThreadedOdometry, DropsTheOldestFrameOfAFullQueueIfConfigured) {
  const SlidingPlane plane(8);
  std::vector<std::int64_t> ids;
  ThreadedOdometry odometry(
      inertial_config(), inertial_plane_rig(plane),
      {.on_frame = {[&](const FrameReport& report) { ids.push_back(report.update.frame_id); }},
       .queue_capacity = 2,
       .full_queue = FullQueuePolicy::kDropOldest});
  // Without samples, the tracker holds at most one frame and the queue two.
  for (std::size_t i = 0; i < 8; ++i) odometry.add_frame(plane.frame(i));
  EXPECT_GE(odometry.dropped_frames(), 5u);
  odometry.finish();
  EXPECT_EQ(ids.size() + odometry.dropped_frames(), 8u);
  EXPECT_EQ(ids.back(), 7);
}

TEST(ThreadedOdometry, DetectsInFramesThatEnterTheWindow) {
  const SlidingPlane plane(7);
  OdometryConfig config = visual_config();
  config.backend.rate_hz = 10.0;
  std::vector<std::int64_t> detected, boxed;
  const auto detect = [&](const Frame& frame) -> DetectionSet {
    detected.push_back(frame.id);
    const Detection person{.class_name = "person", .score = 1.0, .box = {10.0, 10.0, 60.0, 100.0}};
    return {.t = frame.t, .state = DetectionState::kPresent, .detections = {person}};
  };
  const auto on_frame = [&](const FrameReport& report) {
    if (!report.dynamic.boxes.empty()) boxed.push_back(report.frame.id);
  };
  ThreadedOdometry odometry(config, plane.input().rig, {.detect = detect, .on_frame = {on_frame}});
  for (std::size_t i = 0; i < 7; ++i) odometry.add_frame(plane.frame(i));
  odometry.finish();
  EXPECT_EQ(detected, (std::vector<std::int64_t>{0, 3, 6}));
  EXPECT_EQ(boxed, detected);
}

TEST(ThreadedOdometry, PredictsTheStateWhileItRuns) {
  const SlidingPlane plane(kFrames);
  ThreadedOdometry odometry(inertial_config(), inertial_plane_rig(plane), {});
  EXPECT_FALSE(odometry.state_at(plane.frame(0).t).has_value());
  for (const ImuSample& sample : plane_imu(2.0)) odometry.add_imu(sample);
  for (std::size_t i = 0; i < kFrames; ++i) {
    odometry.add_frame(plane.frame(i));
    const std::optional<NavState> state = odometry.state();
    if (state) {
      EXPECT_LE(state->t, plane.frame(i).t);
    }
  }
  odometry.finish();
  const NavState newest = odometry.state().value();
  EXPECT_EQ(newest.t, plane.frame(kFrames - 1).t);
  const NavState later = odometry.state_at(after(newest.t, 0.1)).value();
  EXPECT_NEAR((later.T_w_b.p - newest.T_w_b.p).norm(), kPlaneSpeed_m_per_s * 0.1, 0.01);
}

/// The exception must be thrown by a call of `add_frame`, or at the latest by `finish`.
template <class Error>
void expect_exception_of_a_thread(ThreadedOdometryOptions options, Frame last) {
  const SlidingPlane plane(20);
  ThreadedOdometry odometry(visual_config(), plane.input().rig, std::move(options));
  const auto run = [&] {
    for (std::size_t i = 0; i < 10; ++i) odometry.add_frame(plane.frame(i));
    if (!last.gray.empty()) odometry.add_frame(std::move(last));
    odometry.finish();
  };
  EXPECT_THROW(run(), Error);
  EXPECT_THROW(odometry.finish(), Error);
}

TEST(ThreadedOdometry, PropagatesTheExceptionOfEachThread) {
  const SlidingPlane plane(20);
  expect_exception_of_a_thread<std::runtime_error>(
      {.on_frame = {[](const FrameReport&) { throw std::runtime_error("disk error"); }}}, {});
  expect_exception_of_a_thread<std::runtime_error>(
      {.detect = [](const Frame&) -> DetectionSet { throw std::runtime_error("no network"); }}, {});
  Frame wrong = plane.frame(19);
  wrong.gray = cv::Mat(10, 10, CV_8UC1, cv::Scalar(0));
  expect_exception_of_a_thread<InputError>({}, wrong);
}

TEST(ThreadedOdometry, RejectsAFrameEarlierThanThePreviousOne) {
  const SlidingPlane plane(2);
  Positions positions;
  ThreadedOdometry odometry(visual_config(), plane.input().rig, recording(positions));
  odometry.add_frame(plane.frame(1));
  expect_input_error([&] { odometry.add_frame(plane.frame(0)); }, {"is earlier than the previous frame"});
  odometry.finish();
  EXPECT_EQ(positions.size(), 1u);
}

}  // namespace
}  // namespace stillpoint
