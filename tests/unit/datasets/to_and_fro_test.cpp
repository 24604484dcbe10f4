// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/to_and_fro.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace stillpoint {
namespace {

constexpr std::int64_t kStart_ns = 1000;

/// Pictures at 1000, 1010 and 1030 ns, a box in the second, true poses at every 10 ns from 990 to 1040.
class ThreePictures final : public SensorStream {
 public:
  ThreePictures() {
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
    frame.depth_units_per_m = static_cast<double>(index);  // to tell them apart
    return frame;
  }
  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t) const override { return std::nullopt; }

 private:
  SequenceInfo info_;
};

TEST(ToAndFro, GoesOnAtEachTurnWithoutAJump) {
  const auto stream = play_to_and_fro(std::make_unique<ThreePictures>(), 3);
  // 0 10 30 | back from 30: 20 later the one at 10, 30 later that at 0 | forwards again
  const std::vector<std::int64_t> expected = {0, 10, 30, 50, 60, 70, 90};
  const std::vector<double> pictures = {0, 1, 2, 1, 0, 1, 2};
  ASSERT_EQ(stream->info().frame_times.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(stream->info().frame_times[i].ns, kStart_ns + expected[i]);
    const Frame frame = stream->load_frame(i);
    EXPECT_EQ(frame.depth_units_per_m, pictures[i]);
    EXPECT_EQ(frame.id, static_cast<std::int64_t>(i));
    EXPECT_EQ(frame.t, stream->info().frame_times[i]);
  }
}

TEST(ToAndFro, BoxesAndTruePosesFollowThePictures) {
  const auto stream = play_to_and_fro(std::make_unique<ThreePictures>(), 2);
  ASSERT_EQ(stream->info().detections.size(), 2u);
  EXPECT_EQ(stream->info().detections[0].t.ns, kStart_ns + 10);
  EXPECT_EQ(stream->info().detections[1].t.ns, kStart_ns + 50);
  // within the pictures' time, the one at the turn once: at 0, 10, 20, 30 and back at 20, 10, 0
  const std::vector<StampedPose>& poses = stream->info().ground_truth.trajectory.poses;
  ASSERT_EQ(poses.size(), 7u);
  const std::vector<double> places = {0, 10, 20, 30, 20, 10, 0};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].t.ns, kStart_ns + 10 * static_cast<std::int64_t>(i));
    EXPECT_EQ(poses[i].T_w_f.p.x(), places[i]);
  }
}

TEST(ToAndFro, HasNoInertialData) {
  const auto stream = play_to_and_fro(std::make_unique<ThreePictures>(), 1);
  EXPECT_TRUE(stream->info().imu.empty());
  EXPECT_FALSE(stream->info().rig.has_imu);
}

TEST(ToAndFro, RefusesToPlayNothing) {
  EXPECT_THROW(static_cast<void>(play_to_and_fro(std::make_unique<ThreePictures>(), 0)), InputError);
}

}  // namespace
}  // namespace stillpoint
