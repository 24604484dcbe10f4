// SPDX-License-Identifier: BSD-3-Clause
// Relocalization after a loss, in the map of the keyframes before it.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/geometry/so3.h"
#include "core/loop/loop_closure.h"
#include "tests/unit/loop/painted_wall.h"

namespace stillpoint {
namespace {

/// A run along a wall. After losses, its odometry continues in other worlds.
class RunWithSegments {
 public:
  /// A frame in front of the wall, 2.5 m away.
  DepartedKeyframe frame_at(const cv::Mat& wall, double x_m, int segment) {
    const Pose T_w_c{Eigen::Quaterniond::Identity(), {x_m, 1.5, -2.5}};
    DepartedKeyframe keyframe = keyframe_at(wall, T_w_c, next_++);
    keyframe.segment = segment;
    keyframe.T_w_b = origin_of(segment) * T_w_c;
    return keyframe;
  }
  static Pose origin_of(int segment) {
    const double s = segment;
    return {exp_so3({0.0, 0.0, s}), {3.0 * s, 2.0 * s, s}};
  }
  void add(const cv::Mat& wall, double begin_m, int count, int segment) {
    for (int i = 0; i < count; ++i) T_m_w_ = closure.add(frame_at(wall, begin_m + 0.15 * i, segment));
  }
  void locate(const cv::Mat& wall, double begin_m, int count, int segment) {
    for (int i = 0; i < count; ++i) T_m_w_ = closure.locate(frame_at(wall, begin_m + 0.03 * i, segment));
  }
  /// Of the last pose T_m_w, which is the inverse of the origin.
  [[nodiscard]] double error_m(int segment) const { return (T_m_w_ * origin_of(segment)).p.norm(); }
  [[nodiscard]] Pose T_m_w() const { return T_m_w_; }

  LoopClosure closure{{.enabled = true}, kWallCamera, false};

 private:
  int next_ = 0;
  Pose T_m_w_;
};

TEST(Segments, AfterALossTheViewOfAnEarlierPlaceIsLocatedInTheSameWorld) {
  const cv::Mat wall = painted_wall(1);
  for (const bool current_frames : {false, true}) {
    RunWithSegments run;
    run.add(wall, 3.0, 30, 0);
    ASSERT_TRUE(run.closure.is_located());
    current_frames ? run.locate(wall, 5.0, 4, 1) : run.add(wall, 5.0, 6, 1);
    EXPECT_TRUE(run.closure.is_located()) << current_frames;
    EXPECT_LT(run.error_m(1), 0.05) << current_frames;
  }
}

TEST(Segments, ThePlacesJustBeforeALossAreLookedUp) {
  // All of them are younger than `loop.min_gap_s`.
  const cv::Mat wall = painted_wall(1);
  RunWithSegments run;
  run.add(wall, 3.0, 10, 0);
  run.locate(wall, 4.2, 4, 1);
  EXPECT_TRUE(run.closure.is_located());
}

TEST(Segments, ASegmentAtAnotherPlaceHasNoPoseInTheMap) {
  const cv::Mat wall = painted_wall(1), other = painted_wall(2);
  RunWithSegments run;
  run.add(wall, 3.0, 20, 0);
  run.add(other, 5.0, 10, 1);
  EXPECT_FALSE(run.closure.is_located());
  EXPECT_EQ(run.T_m_w().p, Eigen::Vector3d::Zero());
  run.add(wall, 4.0, 6, 2);  // the next one is located by the first, not by the second
  EXPECT_TRUE(run.closure.is_located());
  EXPECT_LT(run.error_m(2), 0.05);
  const LoopReport report = run.closure.finish();
  ASSERT_EQ(report.keyframes.size(), 36u);
  for (const MapKeyframe& keyframe : report.keyframes)
    EXPECT_EQ(keyframe.is_located, keyframe.segment != 1) << keyframe.frame;
  EXPECT_EQ(report.map->keyframes.size(), 26u);
}

TEST(Segments, ASegmentThatIsNotLocatedDoesNotLocateTheNextOne) {
  const cv::Mat wall = painted_wall(1);
  RunWithSegments run;
  run.add(wall, 3.0, 10, 0);
  run.add(painted_wall(2), 5.0, 10, 1);
  run.add(painted_wall(2), 5.6, 4, 2);
  EXPECT_FALSE(run.closure.is_located());
  for (const LoopRecord& loop : run.closure.finish().loops) EXPECT_NE(loop.outcome, LoopOutcome::kAccepted);
}

}  // namespace
}  // namespace stillpoint
