// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/run_scores.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

/// Left third: a person at rest; middle third: a cart; right third: static background.
datasets::MotionLabels three_thirds(int cart_speed_cm_per_s) {
  datasets::MotionLabels labels{.object = cv::Mat::zeros(30, 90, CV_8UC1),
                                .speed_cm_per_s = cv::Mat::zeros(30, 90, CV_8UC1)};
  labels.object.colRange(0, 30) = 1;
  labels.object.colRange(30, 60) = datasets::kFirstUndetectableObject;
  labels.speed_cm_per_s.colRange(30, 60) = cart_speed_cm_per_s;
  return labels;
}

const datasets::SequenceInfo kNoTruth;

TrackedFeature feature(std::int64_t id, double u, int age = 5) {
  return {.id = id, .pixel = {u, 15.0}, .age = age};
}
DynamicLabel flagged(std::int64_t id) { return {.id = id, .label = LabelClass::kDynamicMotion}; }
DynamicLabel stable(std::int64_t id) { return {.id = id}; }

TEST(LabelScore, CountsFlaggedFeaturesPerGroup) {
  const std::vector<TrackedFeature> features = {feature(1, 10.0), feature(2, 15.0), feature(3, 45.0),
                                                feature(4, 75.0), feature(5, 80.0)};
  const std::vector<DynamicLabel> labels = {flagged(1), stable(2), flagged(3), flagged(4), stable(5)};
  LabelScore score;
  score.add(features, labels, three_thirds(40), DriftedTracks(kNoTruth));
  EXPECT_EQ(score.people.flagged_ratio(), 0.5);                // 1 of {1, 2}
  EXPECT_EQ(score.undetectable_objects.flagged_ratio(), 1.0);  // 3
  EXPECT_EQ(score.background.flagged_ratio(), 0.5);            // 4 of {4, 5}
  EXPECT_EQ(score.precision(), 2.0 / 3.0);                     // 1 and 3 of {1, 3, 4}
}

TEST(LabelScore, ExcludesNewFeaturesOutlinesAndObjectsAtRest) {
  const std::vector<TrackedFeature> features = {feature(1, 10.0, 1), feature(2, 28.0), feature(3, 45.0)};
  const std::vector<DynamicLabel> labels = {flagged(1), flagged(2), flagged(3)};
  LabelScore score;
  score.add(features, labels, three_thirds(0), DriftedTracks(kNoTruth));
  EXPECT_EQ(score.people.flagged_ratio(), std::nullopt);
  EXPECT_EQ(score.undetectable_objects.flagged_ratio(), std::nullopt);
  EXPECT_EQ(score.precision(), std::nullopt);
}

TEST(LabelScore, SkipsFeaturesWithoutALabel) {
  const std::vector<TrackedFeature> features = {feature(1, 10.0), feature(3, 15.0)};
  const std::vector<DynamicLabel> labels = {flagged(3)};
  LabelScore score;
  score.add(features, labels, three_thirds(0), DriftedTracks(kNoTruth));
  EXPECT_EQ(score.people.all, 1);
}

/// A static camera at the origin, focal length 100 px.
datasets::SequenceInfo static_camera() {
  datasets::SequenceInfo info;
  info.rig.camera = {.width = 90, .height = 30, .fx = 100.0, .fy = 100.0, .cx = 45.0, .cy = 15.0};
  info.ground_truth.trajectory.poses = {{from_seconds(0.0), {}}, {from_seconds(10.0), {}}};
  return info;
}

TrackedFrame observed_at(double t, double u) {
  const double x = (u - 45.0) / 100.0;
  return {.t = from_seconds(t),
          .features = {{.id = 1, .pixel = {u, 15.0}, .bearing = {x, 0.0}, .depth = 2.0}}};
}

TEST(DriftedTracks, MoveInTheImageOfAStaticCameraAndScene) {
  const datasets::SequenceInfo info = static_camera();
  DriftedTracks drifted(info);
  drifted.add(observed_at(1.0, 75.0));
  drifted.add(observed_at(2.0, 78.0));
  EXPECT_FALSE(drifted.contains(1));  // 3 px: within the tolerance
  drifted.add(observed_at(3.0, 80.0));
  EXPECT_TRUE(drifted.contains(1));
  LabelScore score;
  score.add(observed_at(3.0, 80.0).features, std::vector{flagged(1)}, three_thirds(0), drifted);
  EXPECT_EQ(score.background.all, 0);
}

}  // namespace
}  // namespace stillpoint::bench
