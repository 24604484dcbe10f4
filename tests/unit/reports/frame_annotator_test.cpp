// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/annotated_frames.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/support/fake_frame_report.h"

namespace stillpoint::report {
namespace {

/// Classifies the colors documented in the header by their dominant channels.
bool is_green(const cv::Vec3b& rgb) { return rgb[1] > 150 && rgb[0] < 100 && rgb[2] < 100; }
bool is_red(const cv::Vec3b& rgb) { return rgb[0] > 150 && rgb[1] < 100 && rgb[2] < 100; }
bool is_white(const cv::Vec3b& rgb) { return rgb[0] > 200 && rgb[1] > 200 && rgb[2] > 200; }
bool is_purple(const cv::Vec3b& rgb) { return rgb[2] > 100 && rgb[2] > rgb[0] && rgb[0] > rgb[1]; }
bool is_black(const cv::Vec3b& rgb) { return rgb == cv::Vec3b(0, 0, 0); }

TEST(FrameAnnotator, ColorsFeaturesByTheirLabels) {
  FakeFrameReport fake(0);
  fake.add_feature(1, 20.0, 20.0);
  fake.add_feature(2, 60.0, 20.0);
  fake.add_feature(3, 100.0, 20.0);
  fake.dynamic.labels = {{.id = 1}, {.id = 2, .label = LabelClass::kDynamicObject}};
  const cv::Mat drawn = FrameAnnotator({}).annotate(fake.report());
  EXPECT_TRUE(is_green(drawn.at<cv::Vec3b>(20, 20)));
  EXPECT_TRUE(is_red(drawn.at<cv::Vec3b>(20, 60)));
  EXPECT_TRUE(is_white(drawn.at<cv::Vec3b>(20, 100)));
}

TEST(FrameAnnotator, KeepsTheLabelInFramesWithoutANewOne) {
  FakeFrameReport first(0);
  first.add_feature(1, 20.0, 20.0);
  first.dynamic.labels = {{.id = 1, .label = LabelClass::kDynamicObject}};
  FakeFrameReport second(1);
  second.add_feature(1, 24.0, 20.0);
  FrameAnnotator annotator({});
  static_cast<void>(annotator.annotate(first.report()));
  EXPECT_TRUE(is_red(annotator.annotate(second.report()).at<cv::Vec3b>(20, 24)));
}

TEST(FrameAnnotator, DrawsTheTrackOfAFeature) {
  FakeFrameReport first(0);
  first.add_feature(1, 20.0, 20.0);
  FakeFrameReport second(1);
  second.add_feature(1, 60.0, 20.0);
  FrameAnnotator annotator({});
  static_cast<void>(annotator.annotate(first.report()));
  EXPECT_TRUE(is_white(annotator.annotate(second.report()).at<cv::Vec3b>(20, 40)));
}

TEST(FrameAnnotator, DrawsACircleWhereAFeatureWasLost) {
  FakeFrameReport first(0);
  first.add_feature(1, 60.0, 50.0);
  FrameAnnotator annotator({.unstable_radius_px = 20});
  static_cast<void>(annotator.annotate(first.report()));
  const cv::Mat after = annotator.annotate(FakeFrameReport(1).report());
  EXPECT_TRUE(is_purple(after.at<cv::Vec3b>(50, 80)));  // 60 + 20
  const cv::Mat later = annotator.annotate(FakeFrameReport(2).report());
  EXPECT_TRUE(is_black(later.at<cv::Vec3b>(50, 80)));
}

TEST(FrameAnnotator, TintsPixelsNearerThanTheThresholdOfTheirBox) {
  FakeFrameReport fake(0);
  fake.frame.depth.setTo(4000);
  fake.frame.depth(cv::Rect(45, 45, 20, 20)).setTo(1000);  // an object 1 m away before a wall at 4 m
  const std::vector<Box> boxes{{.x_min = 20, .y_min = 20, .x_max = 90, .y_max = 90}};
  fake.dynamic.mask =
      SemanticMask(boxes, {fake.frame.depth, 1000.0}, fake.frame.gray.size(),
                   DynamicConfig{.mask = DynamicMask::kDepthThreshold, .epsilon_m = 0.5, .box_margin_px = 0});
  ASSERT_EQ(fake.dynamic.mask.boxes().size(), 1u);
  const cv::Mat drawn = FrameAnnotator({}).annotate(fake.report());
  // Center at 1 m, corners at 4 m: the threshold is in the middle, 2.5 m.
  EXPECT_FALSE(is_black(drawn.at<cv::Vec3b>(50, 50)));
  EXPECT_TRUE(is_black(drawn.at<cv::Vec3b>(80, 80)));
}

TEST(FrameAnnotator, WritesTheCorrectionByALoopForThirtyFrames) {
  FrameAnnotator annotator({});
  const auto has_text = [&](std::int64_t id, double corrected_m) {
    FakeFrameReport fake(id, {400, 120});
    fake.update.T_m_w.p.x() = corrected_m;
    const cv::Mat drawn = annotator.annotate(fake.report());
    return cv::norm(drawn.rowRange(82, 96), cv::NORM_INF) > 0.0;  // above the status
  };
  EXPECT_FALSE(has_text(0, 0.0));
  for (int i = 1; i <= 30; ++i) EXPECT_TRUE(has_text(i, 0.05)) << i;
  EXPECT_FALSE(has_text(31, 0.05));
}

TEST(FrameAnnotator, LocatingAWorldInTheMapIsNotACorrection) {
  FrameAnnotator annotator({});
  FakeFrameReport before(0, {400, 120});
  before.update.in_map = false;
  static_cast<void>(annotator.annotate(before.report()));
  FakeFrameReport located(1, {400, 120});
  located.update.T_m_w.p.x() = 3.0;
  EXPECT_EQ(cv::norm(annotator.annotate(located.report()).rowRange(82, 96), cv::NORM_INF), 0.0);
}

TEST(FrameAnnotator, DoesNotModifyTheFrame) {
  FakeFrameReport fake(0);
  fake.frame.color = cv::Mat::zeros(120, 160, CV_8UC3);
  fake.add_feature(1, 20.0, 20.0);
  static_cast<void>(FrameAnnotator({.stable_radius_px = 10}).annotate(fake.report()));
  EXPECT_TRUE(is_black(fake.frame.color.at<cv::Vec3b>(20, 20)));
}

}  // namespace
}  // namespace stillpoint::report
