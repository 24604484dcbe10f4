// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/landmark_samples.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/fake_frame_report.h"

namespace stillpoint::report {
namespace {

/// A frame of a camera at (1, 0, 0) with features 0, 1, ... straight ahead, 1, 2, ... m away.
void add_labels(LandmarkSamples& samples, double t_s, const std::vector<LabelClass>& labels,
                OdometryStatus status = OdometryStatus::kTracking) {
  FakeFrameReport fake(0);
  fake.frame.t = from_seconds(t_s);
  fake.update.status = status;
  fake.update.T_w_c.p.x() = 1.0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto id = static_cast<std::int64_t>(i);
    fake.tracked.features.push_back({.id = id, .depth = 1.0 + static_cast<double>(i)});
    fake.dynamic.labels.push_back({.id = id, .label = labels[i]});
  }
  samples.add(fake.report());
}

TEST(LandmarkSamples, TakeAFeatureOncePerLabelInLocatedFrames) {
  LandmarkSamples samples;
  add_labels(samples, 0.0, {LabelClass::kStable}, OdometryStatus::kLost);
  add_labels(samples, 0.1, {LabelClass::kStable, LabelClass::kDynamicMotion});
  add_labels(samples, 0.2, {LabelClass::kStable, LabelClass::kStable, LabelClass::kStable});  // too early
  add_labels(samples, 0.6, {LabelClass::kStable, LabelClass::kStable});
  EXPECT_EQ(samples.text(), "x,y,z,dynamic\n1.000,0.000,1.000,0\n1.000,0.000,2.000,1\n1.000,0.000,2.000,0\n");
}

TEST(LandmarkSamples, AreLimitedAtEqualSteps) {
  LandmarkSamples samples;
  add_labels(samples, 0.0, std::vector<LabelClass>(3001, LabelClass::kStable));
  const auto landmarks = bench::parse_landmarks(samples.text(), "landmarks");
  ASSERT_EQ(landmarks.size(), 1001u);  // every third one: every second one would be 1501
  EXPECT_EQ(landmarks.back().p_w, Eigen::Vector3d(1.0, 0.0, 3001.0));
}

TEST(LandmarkSamples, AreReadAsWrittenAndRejectedIfDamaged) {
  const std::vector<bench::LandmarkSample> one = {{.p_w = {1.5, -2.0, 0.25}, .dynamic = true}};
  const auto read = bench::parse_landmarks(bench::landmark_text(one), "landmarks");
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].p_w, one[0].p_w);
  EXPECT_TRUE(read[0].dynamic);
  expect_input_error(
      [] { static_cast<void>(bench::parse_landmarks("x,y,z,dynamic\n1,2,?,0\n", "landmarks of run k")); },
      {"landmarks of run k"});
}

}  // namespace
}  // namespace stillpoint::report
