// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/loop_closure.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint {
namespace {

const Camera kCamera{.width = 64, .height = 48, .fx = 60.0, .fy = 60.0, .cx = 31.5, .cy = 23.5};

TEST(LoopClosure, RejectsFiveDegreesOfFreedom) {
  expect_input_error([] { LoopClosure({.dof = 5}, kCamera, true); }, {"loop.dof"});
}

TEST(LoopClosure, RejectsFourDegreesOfFreedomWithoutAnImu) {
  expect_input_error([] { LoopClosure({.dof = 4}, kCamera, false); }, {"loop.dof"});
}

TEST(LoopClosure, RejectsKeyframesWithoutADepthImage) {
  LoopClosure closure({}, kCamera, true);
  const DepartedKeyframe keyframe{.gray = cv::Mat(48, 64, CV_8UC1, cv::Scalar(90))};
  expect_input_error([&] { static_cast<void>(closure.add(keyframe)); }, {"depth images"});
}

TEST(LoopClosure, WithoutLoopsTheMapIsTheWorldOfTheOdometry) {
  LoopClosure closure({}, kCamera, true);
  for (int k = 0; k < 3; ++k) {
    const Pose T_w_b{Eigen::Quaterniond::Identity(), {0.2 * k, 0.0, 0.0}};
    const Pose T_m_w = closure.add({.frame = k,
                                    .t = from_seconds(k),
                                    .T_w_b = T_w_b,
                                    .gray = cv::Mat(48, 64, CV_8UC1, cv::Scalar(90)),
                                    .depth = cv::Mat(48, 64, CV_16UC1, cv::Scalar(1000))});
    EXPECT_TRUE(T_m_w.p.isZero(0.0));
  }
  const LoopReport report = closure.finish();
  ASSERT_EQ(report.keyframes.size(), 3u);
  EXPECT_EQ(report.keyframes[2].T_m_b.p, Eigen::Vector3d(0.4, 0.0, 0.0));
  EXPECT_TRUE(report.loops.empty());
  // The images have no features. The vectors of keyframes and poses have grown from one element to four.
  EXPECT_EQ(report.keyframes[2].cost.memory_bytes - report.keyframes[0].cost.memory_bytes,
            3 * (sizeof(Keyframe) + 2 * sizeof(Pose)));
}

TEST(LoopClosure, TheBundleAdjustmentIsAnOption) {
  for (const bool is_on : {false, true}) {
    LoopClosure closure({.final_bundle_adjustment = is_on}, kCamera, true);
    static_cast<void>(closure.add({.t = from_seconds(1),
                                   .gray = cv::Mat(48, 64, CV_8UC1, cv::Scalar(90)),
                                   .depth = cv::Mat(48, 64, CV_16UC1, cv::Scalar(1000))}));
    EXPECT_EQ(closure.finish().bundle_adjustment.has_value(), is_on);
  }
}

}  // namespace
}  // namespace stillpoint
