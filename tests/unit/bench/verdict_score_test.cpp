// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/verdict_score.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

/// Left third a person at rest, middle third a cart, right third the standing world.
MotionLabels three_thirds(int cart_speed_cm_per_s) {
  MotionLabels labels{.object = cv::Mat::zeros(30, 90, CV_8UC1),
                      .speed_cm_per_s = cv::Mat::zeros(30, 90, CV_8UC1)};
  labels.object.colRange(0, 30) = 1;
  labels.object.colRange(30, 60) = kFirstUnknownMover;
  labels.speed_cm_per_s.colRange(30, 60) = cart_speed_cm_per_s;
  return labels;
}

const SequenceInfo kNoTruth;

TrackedFeature feature(std::int64_t id, double u, int age = 5) {
  return {.id = id, .pixel = {u, 15.0}, .age = age};
}
FeatureVerdict flagged(std::int64_t id) { return {.id = id, .verdict = Verdict::kDynamicMotion}; }
FeatureVerdict stable(std::int64_t id) { return {.id = id}; }

TEST(VerdictScore, CountsWhatIsFlaggedOnEachKindOfSurface) {
  const std::vector<TrackedFeature> features = {feature(1, 10.0), feature(2, 15.0), feature(3, 45.0),
                                                feature(4, 75.0), feature(5, 80.0)};
  const std::vector<FeatureVerdict> verdicts = {flagged(1), stable(2), flagged(3), flagged(4), stable(5)};
  VerdictScore score;
  score.add(features, verdicts, three_thirds(40), SlidTracks(kNoTruth));
  EXPECT_EQ(score.people.share(), 0.5);          // 1 of {1, 2}
  EXPECT_EQ(score.unknown_movers.share(), 1.0);  // 3
  EXPECT_EQ(score.background.share(), 0.5);      // 4 of {4, 5}
  EXPECT_EQ(score.precision(), 2.0 / 3.0);       // 1 and 3 of {1, 3, 4}
}

TEST(VerdictScore, LeavesOutTheNewTheOutlineAndRestingMovers) {
  const std::vector<TrackedFeature> features = {feature(1, 10.0, 1), feature(2, 28.0), feature(3, 45.0)};
  const std::vector<FeatureVerdict> verdicts = {flagged(1), flagged(2), flagged(3)};
  VerdictScore score;
  score.add(features, verdicts, three_thirds(0), SlidTracks(kNoTruth));
  EXPECT_EQ(score.people.share(), std::nullopt);
  EXPECT_EQ(score.unknown_movers.share(), std::nullopt);
  EXPECT_EQ(score.precision(), std::nullopt);
}

TEST(VerdictScore, PassesOverFeaturesWithoutAVerdict) {
  const std::vector<TrackedFeature> features = {feature(1, 10.0), feature(3, 15.0)};
  const std::vector<FeatureVerdict> verdicts = {flagged(3)};
  VerdictScore score;
  score.add(features, verdicts, three_thirds(0), SlidTracks(kNoTruth));
  EXPECT_EQ(score.people.all, 1);
}

/// A camera that stands at the origin, focal length 100 px.
SequenceInfo standing_camera() {
  SequenceInfo info;
  info.rig.camera = {.width = 90, .height = 30, .fx = 100.0, .fy = 100.0, .cx = 45.0, .cy = 15.0};
  info.ground_truth.trajectory.poses = {{from_seconds(0.0), {}}, {from_seconds(10.0), {}}};
  return info;
}

TrackedFrame seen_at(double t, double u) {
  const double x = (u - 45.0) / 100.0;
  return {.t = from_seconds(t),
          .features = {{.id = 1, .pixel = {u, 15.0}, .bearing = {x, 0.0}, .depth = 2.0}}};
}

TEST(SlidTracks, AreThoseThatMoveThoughTheirPointDoesNot) {
  const SequenceInfo info = standing_camera();
  SlidTracks slid(info);
  slid.add(seen_at(1.0, 75.0));
  slid.add(seen_at(2.0, 78.0));
  EXPECT_FALSE(slid.contains(1));  // 3 px: a corner is no sharper
  slid.add(seen_at(3.0, 80.0));
  EXPECT_TRUE(slid.contains(1));
  VerdictScore score;
  score.add(seen_at(3.0, 80.0).features, std::vector{flagged(1)}, three_thirds(0), slid);
  EXPECT_EQ(score.background.all, 0);
}

}  // namespace
}  // namespace stillpoint
