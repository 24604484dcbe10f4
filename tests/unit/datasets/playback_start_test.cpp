// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sensor_stream.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

/// Frames at 10, 11, 12 and 13 s; IMU samples, true poses and boxes every 0.5 s from 9.5 s to 13.5 s.
class FourFrames final : public SensorStream {
 public:
  FourFrames() {
    info_.name = "four";
    for (int i = 0; i < 4; ++i) info_.frame_times.push_back(from_seconds(10 + i));
    for (int i = 0; i < 9; ++i) {
      const Timestamp t = from_seconds(9.5 + 0.5 * i);
      info_.imu.push_back({.t = t});
      info_.ground_truth.trajectory.poses.push_back({t, Pose{}});
      info_.detections.push_back({.t = t, .state = DetectionState::kPresent});
      info_.true_boxes.push_back({.t = t, .state = DetectionState::kPresent});
    }
  }
  [[nodiscard]] const SequenceInfo& info() const override { return info_; }
  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    Frame frame;
    frame.id = static_cast<std::int64_t>(index);
    frame.t = info_.frame_times[index];
    return frame;
  }
  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t index) const override {
    return index < 2 ? std::nullopt : std::optional<MotionLabels>(MotionLabels{});
  }

 private:
  SequenceInfo info_;
};

TEST(PlaybackStart, LeavesOutFramesBeforeTheStart) {
  // 1.2 s after 10 s: the frames at 12 and 13 s remain.
  const auto stream = start_at(std::make_unique<FourFrames>(), 1.2);
  ASSERT_EQ(stream->info().frame_times, (std::vector{from_seconds(12.0), from_seconds(13.0)}));
  const Frame frame = stream->load_frame(1);
  EXPECT_EQ(frame.id, 1);
  EXPECT_EQ(frame.t, from_seconds(13.0));
  EXPECT_TRUE(stream->load_labels(0).has_value());  // of frame 2
  EXPECT_EQ(stream->info().notes.size(), 1U);
}

TEST(PlaybackStart, LeavesOutSamplesPosesAndBoxesBeforeTheStart) {
  // Of 9.5, 10.0, ..., 13.5 s those from 11.5 s on: five.
  const auto stream = start_at(std::make_unique<FourFrames>(), 1.2);
  const SequenceInfo& info = stream->info();
  ASSERT_EQ(info.imu.size(), 5U);
  EXPECT_EQ(info.imu.front().t, from_seconds(11.5));
  EXPECT_EQ(info.ground_truth.trajectory.poses.size(), 5U);
  EXPECT_EQ(info.detections.size(), 5U);
  EXPECT_EQ(info.true_boxes.size(), 5U);
}

TEST(PlaybackStart, AStartAtAFrameIncludesIt) {
  EXPECT_EQ(start_at(std::make_unique<FourFrames>(), 3.0)->info().frame_times.size(), 1U);
}

TEST(PlaybackStart, AStartAtZeroKeepsSamplesBeforeTheFirstFrame) {
  const auto stream = start_at(std::make_unique<FourFrames>(), 0.0);
  EXPECT_EQ(stream->info().imu.size(), 9U);
  EXPECT_TRUE(stream->info().notes.empty());
}

TEST(PlaybackStart, AStartPastTheEndIsAnError) {
  try {
    static_cast<void>(start_at(std::make_unique<FourFrames>(), 3.01));
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "--start: 3.01 s is past the end of four, whose last frame is at 3.00 s; use a smaller value");
  }
}

TEST(LowerFrameRate, PlaysTheFirstFrameAndEveryNth) {
  const auto stream = every_nth_frame(std::make_unique<FourFrames>(), 3);
  ASSERT_EQ(stream->info().frame_times, (std::vector{from_seconds(10.0), from_seconds(13.0)}));
  const Frame frame = stream->load_frame(1);
  EXPECT_EQ(frame.id, 1);
  EXPECT_EQ(frame.t, from_seconds(13.0));
  EXPECT_FALSE(stream->load_labels(0).has_value());
  EXPECT_TRUE(stream->load_labels(1).has_value());  // of frame 3
  ASSERT_EQ(stream->info().notes.size(), 1U);
  EXPECT_EQ(stream->info().notes.front(), "1 of 3 frames is played: 2 of 4");
}

TEST(LowerFrameRate, KeepsAllSamplesPosesAndBoxes) {
  const auto stream = every_nth_frame(std::make_unique<FourFrames>(), 3);
  const SequenceInfo& info = stream->info();
  EXPECT_EQ(info.imu.size(), 9U);
  EXPECT_EQ(info.ground_truth.trajectory.poses.size(), 9U);
  EXPECT_EQ(info.detections.size(), 9U);
  EXPECT_EQ(info.true_boxes.size(), 9U);
}

TEST(LowerFrameRate, CountsFromTheStart) {
  const auto stream = every_nth_frame(start_at(std::make_unique<FourFrames>(), 1.0), 2);
  ASSERT_EQ(stream->info().frame_times, (std::vector{from_seconds(11.0), from_seconds(13.0)}));
  EXPECT_EQ(stream->load_frame(1).t, from_seconds(13.0));
}

TEST(LowerFrameRate, OneLeavesTheStreamAsItIs) {
  const auto stream = every_nth_frame(std::make_unique<FourFrames>(), 1);
  EXPECT_EQ(stream->info().frame_times.size(), 4U);
  EXPECT_TRUE(stream->info().notes.empty());
}

TEST(LowerFrameRate, LessThanOneIsAnError) {
  EXPECT_THROW(static_cast<void>(every_nth_frame(std::make_unique<FourFrames>(), 0)), InputError);
}

}  // namespace
}  // namespace stillpoint::datasets
