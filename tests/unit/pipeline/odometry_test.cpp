// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/odometry.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/pipeline/runners/runner.h"
#include "core/pipeline/stages/frame_report.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/simulated/inertial_plane.h"

namespace stillpoint {
namespace {

constexpr int kFrames = 40;

/// Feeds a sliding plane with IMU data to an odometry, frame by frame.
class InertialFeed {
 public:
  explicit InertialFeed(const OdometryConfig& config = inertial_config())
      : odometry(config, inertial_plane_rig(plane_)) {}

  /// Adds the samples up to `end`.
  void add_imu_until(Timestamp end) {
    for (; next_sample_ < imu_.size() && imu_[next_sample_].t <= end; ++next_sample_) {
      odometry.add_imu(imu_[next_sample_]);
    }
  }
  OdometryUpdate& track_next() { return odometry.track(plane_.frame(next_frame_++)); }
  /// Tracks `count` frames with all samples that they need.
  void track_with_imu(int count) {
    for (int i = 0; i < count; ++i) {
      add_imu_until(odometry.needs_imu_until(next_time()));
      track_next();
    }
  }
  [[nodiscard]] Timestamp next_time() const { return plane_.frame(next_frame_).t; }
  [[nodiscard]] const std::vector<ImuSample>& imu() const { return imu_; }

 private:
  SlidingPlane plane_{kFrames};
  std::vector<ImuSample> imu_ = plane_imu(2.0);
  std::size_t next_sample_ = 0;
  std::size_t next_frame_ = 0;

 public:
  Odometry odometry;
};

TEST(Odometry, IsBitEqualToTheSequentialRunnerForEachLag) {
  const SlidingPlane plane(kFrames);
  for (const int lag : {0, 1, 3}) {
    std::vector<StateHashes> expected, actual;
    static_cast<void>(run_sequential(
        plane.input(), visual_config(lag),
        {.on_frame = {[&](const FrameReport& report) { expected.push_back(report.update.hashes); }}}));
    Odometry odometry(visual_config(lag), plane.input().rig);
    for (std::size_t i = 0; i < kFrames; ++i) actual.push_back(odometry.track(plane.frame(i)).hashes);
    ASSERT_EQ(expected.size(), actual.size());
    for (std::size_t i = 0; i < kFrames; ++i) {
      EXPECT_EQ(expected[i].tracking, actual[i].tracking) << "lag " << lag << ", frame " << i;
      EXPECT_EQ(expected[i].optimization, actual[i].optimization) << "lag " << lag << ", frame " << i;
    }
  }
}

TEST(Odometry, DoesNotDependOnHowEarlySamplesAreAdded) {
  InertialFeed just_in_time, all_first;
  all_first.add_imu_until(all_first.imu().back().t);
  for (int i = 0; i < kFrames; ++i) {
    just_in_time.add_imu_until(just_in_time.odometry.needs_imu_until(just_in_time.next_time()));
    EXPECT_EQ(just_in_time.track_next().hashes.optimization, all_first.track_next().hashes.optimization);
  }
  EXPECT_TRUE(all_first.odometry.state().has_value());
}

TEST(Odometry, NeedsSamplesUntil20MsAfterTheExposure) {
  const SlidingPlane plane(1);
  Rig rig = inertial_plane_rig(plane);
  rig.time_offset_s = 0.003;
  EXPECT_EQ(Odometry(inertial_config(), rig).needs_imu_until(from_seconds(1.0)), from_seconds(1.023));
  EXPECT_EQ(Odometry(visual_config(), rig).needs_imu_until(from_seconds(1.0)),
            Timestamp{std::numeric_limits<std::int64_t>::min()});
}

TEST(Odometry, HoldsTheNewestSampleAcrossAShortGap) {
  InertialFeed feed;
  feed.track_with_imu(20);
  feed.add_imu_until(after(feed.next_time(), -0.04));  // less than imu.max_gap_s
  EXPECT_EQ(feed.track_next().status, OdometryStatus::kTracking);
}

TEST(Odometry, LocatesFramesByVisionWhileSamplesAreMissing) {
  OdometryConfig config = inertial_config();
  config.imu.max_gap_s = 0.01;
  InertialFeed feed(config);
  feed.track_with_imu(20);
  feed.track_next();  // within the 20 ms of lookahead plus 10 ms, 33 ms after the previous frame
  const OdometryUpdate& update = feed.track_next();
  EXPECT_EQ(update.status, OdometryStatus::kDegraded);
  EXPECT_EQ(update.reason, StatusReason::kImuGap);
  EXPECT_TRUE(feed.odometry.state().has_value());
  feed.track_with_imu(5);
  EXPECT_EQ(feed.track_next().reason, StatusReason::kImuGap);  // nothing was added for this frame
}

TEST(Odometry, TellsWhichFramesEnterTheWindow) {
  OdometryConfig config = visual_config();
  config.backend.rate_hz = 10.0;
  const SlidingPlane plane(7);
  Odometry odometry(config, plane.input().rig);
  for (std::size_t i = 0; i < 7; ++i) {  // every third frame at 10 of 30 Hz
    const Frame frame = plane.frame(i);
    EXPECT_EQ(odometry.enters_window(frame.t), i % 3 == 0) << i;
    odometry.track(frame);
    EXPECT_EQ(odometry.dynamic().labels.empty(), i % 3 != 0) << i;
  }
}

TEST(Odometry, ReportsTheFeaturesOfTheNewestFrame) {
  const SlidingPlane plane(3);
  Odometry odometry(visual_config(1), plane.input().rig);
  for (std::size_t i = 0; i < 3; ++i) {
    const OdometryUpdate& update = odometry.track(plane.frame(i));
    EXPECT_EQ(odometry.tracked().id, static_cast<std::int64_t>(i));
    EXPECT_EQ(update.counters.tracked_features, static_cast<int>(odometry.tracked().features.size()));
  }
}

TEST(Odometry, HasAStateOnceInitialized) {
  InertialFeed feed;
  EXPECT_FALSE(feed.odometry.state().has_value());
  feed.track_with_imu(3);  // less than backend.initializer.min_span_s
  EXPECT_FALSE(feed.odometry.state().has_value());
  EXPECT_FALSE(feed.odometry.state_at(feed.next_time()).has_value());
  feed.track_with_imu(20);
  feed.add_imu_until(feed.odometry.needs_imu_until(feed.next_time()));
  const OdometryUpdate update = feed.track_next();
  ASSERT_EQ(update.status, OdometryStatus::kTracking);
  EXPECT_EQ(feed.odometry.state()->t, update.state.t);
  EXPECT_EQ(feed.odometry.state()->T_w_b.p, update.state.T_w_b.p);
}

TEST(Odometry, PropagatesTheStateToEachReceivedSample) {
  InertialFeed feed;
  feed.track_with_imu(30);
  const NavState newest = feed.odometry.state().value();
  feed.add_imu_until(after(newest.t, 0.2));
  for (int i = 0; i <= 40; ++i) {
    const Timestamp t = after(newest.t, 0.005 * i);
    const std::optional<NavState> state = feed.odometry.state_at(t);
    ASSERT_TRUE(state.has_value()) << i;
    EXPECT_EQ(state->t, t);
    // Constant velocity along an arbitrary direction of the world.
    EXPECT_NEAR((state->T_w_b.p - newest.T_w_b.p).norm(), kPlaneSpeed_m_per_s * 0.005 * i, 0.01);
  }
}

TEST(Odometry, HoldsTheLastSampleForTheStateAtALaterTime) {
  InertialFeed feed;
  feed.track_with_imu(30);
  const NavState newest = feed.odometry.state().value();
  feed.add_imu_until(after(newest.t, 0.1));
  // The last sample is at most 5 ms before that, and the limit is imu.max_gap_s = 50 ms.
  const std::optional<NavState> held = feed.odometry.state_at(after(newest.t, 0.14));
  ASSERT_TRUE(held.has_value());
  EXPECT_NEAR((held->T_w_b.p - newest.T_w_b.p).norm(), kPlaneSpeed_m_per_s * 0.14, 0.01);
  EXPECT_FALSE(feed.odometry.state_at(after(newest.t, 0.151)).has_value());
  EXPECT_FALSE(feed.odometry.state_at(after(newest.t, -0.001)).has_value());  // earlier than the state
}

TEST(Odometry, ExtrapolatesAtConstantVelocityWithoutAnImu) {
  const SlidingPlane plane(kFrames);
  Odometry odometry(visual_config(), plane.input().rig);
  for (std::size_t i = 0; i + 1 < kFrames; ++i) odometry.track(plane.frame(i));
  const NavState previous = odometry.state().value();
  odometry.track(plane.frame(kFrames - 1));
  const NavState newest = odometry.state().value();
  const NavState later = odometry.state_at(after(newest.t, 0.1)).value();
  // Three frame intervals; the rotation between the frames is negligible.
  const Eigen::Vector3d expected = newest.T_w_b.p + 3.0 * (newest.T_w_b.p - previous.T_w_b.p);
  EXPECT_LT((later.T_w_b.p - expected).norm(), 1e-3);
}

TEST(Odometry, RejectsAnInvalidFrameAndContinues) {
  const SlidingPlane plane(5);
  Odometry odometry(visual_config(), plane.input().rig), undisturbed(visual_config(), plane.input().rig);
  for (std::size_t i = 0; i < 4; ++i) {
    odometry.track(plane.frame(i));
    undisturbed.track(plane.frame(i));
  }
  expect_input_error([&] { odometry.track(plane.frame(2)); }, {"is earlier than the previous frame"});
  Frame wrong = plane.frame(4);
  wrong.gray = cv::Mat(10, 10, CV_8UC1, cv::Scalar(0));
  EXPECT_THROW(odometry.track(wrong), InputError);
  EXPECT_EQ(odometry.track(plane.frame(4)).hashes.optimization,
            undisturbed.track(plane.frame(4)).hashes.optimization);
}

TEST(Odometry, RequiresAnImuIfConfigured) {
  const SlidingPlane plane(1);
  expect_input_error([&] { Odometry(inertial_config(), plane.input().rig); }, {"imu.enabled"});
}

}  // namespace
}  // namespace stillpoint
