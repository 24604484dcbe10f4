// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sensor_stream.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

constexpr std::int64_t kStart_ns = 1000;

/// Frames at 1000, 1010 and 1030 ns, a box in the second, true poses every 10 ns from 990 to 1040.
class ThreeFrames final : public SensorStream {
 public:
  ThreeFrames() {
    info_.name = "three";
    info_.rig.has_imu = true;
    info_.imu.resize(5);
    for (const std::int64_t after : {0, 10, 30}) info_.frame_times.push_back({kStart_ns + after});
    for (std::int64_t after = -10; after <= 40; after += 10) {
      info_.ground_truth.trajectory.poses.push_back(
          {{kStart_ns + after},
           Pose{Eigen::Quaterniond::Identity(), {static_cast<double>(after), 0.0, 0.0}}});
    }
    info_.detections.push_back({.t = info_.frame_times[1], .state = DetectionState::kPresent});
  }
  [[nodiscard]] const SequenceInfo& info() const override { return info_; }
  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    Frame frame;
    frame.depth_units_per_m = static_cast<double>(index);  // identifies the frame
    return frame;
  }
  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t) const override { return std::nullopt; }

 private:
  SequenceInfo info_;
};

TEST(PingPongPlayback, IsContinuousAtTurningPoints) {
  const auto stream = ping_pong_playback(std::make_unique<ThreeFrames>(), 3);
  // 0 10 30 | backwards from 30: 20 ns later the frame at 10, 30 ns later the frame at 0 | forwards again
  const std::vector<std::int64_t> expected = {0, 10, 30, 50, 60, 70, 90};
  const std::vector<double> frames = {0, 1, 2, 1, 0, 1, 2};
  ASSERT_EQ(stream->info().frame_times.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(stream->info().frame_times[i].ns, kStart_ns + expected[i]);
    const Frame frame = stream->load_frame(i);
    EXPECT_EQ(frame.depth_units_per_m, frames[i]);
    EXPECT_EQ(frame.id, static_cast<std::int64_t>(i));
    EXPECT_EQ(frame.t, stream->info().frame_times[i]);
  }
}

TEST(PingPongPlayback, MapsBoxesAndTruePosesToPlaybackTime) {
  const auto stream = ping_pong_playback(std::make_unique<ThreeFrames>(), 2);
  ASSERT_EQ(stream->info().detections.size(), 2u);
  EXPECT_EQ(stream->info().detections[0].t.ns, kStart_ns + 10);
  EXPECT_EQ(stream->info().detections[1].t.ns, kStart_ns + 50);
  // within the time span of the frames, the pose at the turning point once: 0, 10, 20, 30, then 20, 10, 0
  const std::vector<StampedPose>& poses = stream->info().ground_truth.trajectory.poses;
  ASSERT_EQ(poses.size(), 7u);
  const std::vector<double> positions = {0, 10, 20, 30, 20, 10, 0};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].t.ns, kStart_ns + 10 * static_cast<std::int64_t>(i));
    EXPECT_EQ(poses[i].T_w_f.p.x(), positions[i]);
  }
}

TEST(PingPongPlayback, HasNoImuData) {
  const auto stream = ping_pong_playback(std::make_unique<ThreeFrames>(), 1);
  EXPECT_TRUE(stream->info().imu.empty());
  EXPECT_FALSE(stream->info().rig.has_imu);
}

TEST(PingPongPlayback, RejectsZeroPasses) {
  EXPECT_THROW(static_cast<void>(ping_pong_playback(std::make_unique<ThreeFrames>(), 0)), InputError);
}

}  // namespace
}  // namespace stillpoint::datasets
