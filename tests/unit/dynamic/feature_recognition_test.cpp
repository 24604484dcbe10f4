// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/feature_recognition.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

const cv::Size kSize(100, 80);
constexpr Box kBox{.x_min = 20, .y_min = 10, .x_max = 60, .y_max = 70};
const Eigen::Vector2d kInBox(40.0, 40.0);
const Eigen::Vector2d kOutside(80.0, 40.0);

DynamicConfig config() {
  DynamicConfig config;
  config.box_margin_px = 0.0;
  config.mcc_threshold_px = 5.0;
  config.gate_threshold_px = 8.0;
  config.mcc_min_observations = 3;
  return config;
}

/// Threshold 3 m in kBox: the object's centre reads 2 m, the wall 2 m behind does not matter (2 + 1).
SemanticMask person_at_2m() {
  const cv::Mat depth(kSize, CV_16UC1, cv::Scalar(2000));
  return SemanticMask(std::vector{kBox}, {.pixels = depth}, kSize, config());
}

/// Infinite threshold in kBox: nothing measured.
SemanticMask unmeasured_person() { return SemanticMask(std::vector{kBox}, {}, kSize, config()); }

TrackedFrame frame_with(const std::vector<TrackedFeature>& features) {
  TrackedFrame frame;
  frame.features = features;
  return frame;
}

TrackedFeature feature(std::int64_t id, const Eigen::Vector2d& pixel, double depth) {
  TrackedFeature tracked;
  tracked.id = id;
  tracked.pixel = pixel;
  tracked.depth = depth;
  return tracked;
}

/// The verdict on a feature alone in its picture.
FeatureVerdict judge_one(FeatureRecognition& recognition, const TrackedFeature& tracked,
                         const SemanticMask& mask) {
  return recognition.judge(frame_with({tracked}), mask).at(0);
}

FeatureVerdict check_one(FeatureRecognition& recognition, double mean_px, int compared) {
  return recognition
      .check(std::vector{ConsistencyResidual{.id = 1, .mean_px = mean_px, .compared = compared}})
      .at(0);
}

void expect_verdict(const FeatureVerdict& found, Verdict verdict, VerdictReason reason) {
  EXPECT_EQ(verdict_name(found.verdict), verdict_name(verdict));
  EXPECT_EQ(reason_name(found.reason), reason_name(reason));
}

TEST(FeatureRecognition, FlagsWhatIsNearerThanTheThreshold) {
  FeatureRecognition recognition{config()};
  expect_verdict(judge_one(recognition, feature(1, kInBox, 2.9), person_at_2m()), Verdict::kDynamicObject,
                 VerdictReason::kInsideMask);
}

TEST(FeatureRecognition, KeepsBackgroundInsideTheBox) {
  FeatureRecognition recognition{config()};
  expect_verdict(judge_one(recognition, feature(1, kInBox, 3.0), person_at_2m()), Verdict::kStable,
                 VerdictReason::kNothingSuspect);
}

TEST(FeatureRecognition, KeepsWhatIsOutsideOfEveryBox) {
  FeatureRecognition recognition{config()};
  expect_verdict(judge_one(recognition, feature(1, kOutside, 0.5), person_at_2m()), Verdict::kStable,
                 VerdictReason::kNothingSuspect);
}

TEST(FeatureRecognition, TakesUnmeasuredDepthInABoxAsNear) {
  FeatureRecognition recognition{config()};
  expect_verdict(judge_one(recognition, feature(1, kInBox, 0.0), person_at_2m()), Verdict::kDynamicObject,
                 VerdictReason::kInsideMask);
}

TEST(FeatureRecognition, UnmeasuredDepthMayBeKeptUnlessTheThresholdIsInfinite) {
  DynamicConfig published = config();
  published.unmeasured_is_dynamic = false;
  FeatureRecognition recognition{published};
  EXPECT_EQ(judge_one(recognition, feature(1, kInBox, 0.0), person_at_2m()).verdict, Verdict::kStable);
  EXPECT_EQ(judge_one(recognition, feature(1, kInBox, 0.0), unmeasured_person()).verdict,
            Verdict::kDynamicObject);
}

TEST(FeatureRecognition, RemembersWhatWasDynamicWhenItLeavesTheMask) {
  FeatureRecognition recognition{config()};
  static_cast<void>(judge_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  for (int i = 0; i < 3; ++i) {
    expect_verdict(judge_one(recognition, feature(1, kOutside, 2.0), SemanticMask()), Verdict::kDynamicObject,
                   VerdictReason::kHistory);
  }
}

TEST(FeatureRecognition, ForgetsFeaturesThatAreNoLongerTracked) {
  FeatureRecognition recognition{config()};
  static_cast<void>(judge_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  EXPECT_TRUE(recognition.judge(frame_with({}), SemanticMask()).empty());
  EXPECT_EQ(judge_one(recognition, feature(1, kOutside, 2.0), SemanticMask()).verdict, Verdict::kStable);
}

TEST(FeatureRecognition, ResetForgetsEverything) {
  FeatureRecognition recognition{config()};
  static_cast<void>(judge_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  recognition.reset();
  EXPECT_EQ(judge_one(recognition, feature(1, kOutside, 2.0), SemanticMask()).verdict, Verdict::kStable);
}

TEST(FeatureRecognition, JudgesEachFeatureByItsOwnHistory) {
  FeatureRecognition recognition{config()};
  static_cast<void>(recognition.judge(
      frame_with({feature(1, kOutside, 2.0), feature(2, kInBox, 2.0), feature(5, kInBox, 9.0)}),
      person_at_2m()));
  const auto verdicts = recognition.judge(
      frame_with({feature(2, kOutside, 2.0), feature(4, kOutside, 2.0), feature(5, kOutside, 2.0)}),
      SemanticMask());
  ASSERT_EQ(verdicts.size(), 3U);
  EXPECT_EQ(verdicts[0].verdict, Verdict::kDynamicObject);
  EXPECT_EQ(verdicts[1].verdict, Verdict::kStable);
  EXPECT_EQ(verdicts[2].verdict, Verdict::kStable);
}

TEST(FeatureRecognition, CheckFlagsResidualsOverTheThreshold) {
  FeatureRecognition recognition{config()};
  static_cast<void>(judge_one(recognition, feature(1, kOutside, 2.0), SemanticMask()));
  const FeatureVerdict at_threshold = check_one(recognition, 5.0, 4);
  expect_verdict(at_threshold, Verdict::kStable, VerdictReason::kNothingSuspect);
  EXPECT_EQ(at_threshold.residual_px, 5.0);
  expect_verdict(check_one(recognition, 5.1, 1), Verdict::kDynamicMotion, VerdictReason::kResidual);
  expect_verdict(judge_one(recognition, feature(1, kOutside, 2.0), SemanticMask()), Verdict::kDynamicMotion,
                 VerdictReason::kHistory);
}

TEST(FeatureRecognition, CheckRecyclesAfterEnoughObservations) {
  FeatureRecognition recognition{config()};
  static_cast<void>(judge_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  static_cast<void>(judge_one(recognition, feature(1, kOutside, 2.0), SemanticMask()));
  expect_verdict(check_one(recognition, 1.0, 1), Verdict::kDynamicObject, VerdictReason::kHistory);  // two
  expect_verdict(check_one(recognition, 1.0, 2), Verdict::kStable, VerdictReason::kRecycled);  // three views
  expect_verdict(judge_one(recognition, feature(1, kOutside, 2.0), SemanticMask()), Verdict::kStable,
                 VerdictReason::kNothingSuspect);
}

TEST(FeatureRecognition, CheckDoesNotRecycleInsideTheMask) {
  FeatureRecognition recognition{config()};
  static_cast<void>(judge_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  expect_verdict(check_one(recognition, 0.0, 10), Verdict::kDynamicObject, VerdictReason::kInsideMask);
}

TEST(FeatureRecognition, CheckNeedsAResidualToChangeAnything) {
  FeatureRecognition recognition{config()};
  static_cast<void>(
      recognition.judge(frame_with({feature(1, kInBox, 2.0), feature(3, kOutside, 2.0)}), person_at_2m()));
  const auto verdicts =
      recognition.check(std::vector{ConsistencyResidual{.id = 2, .mean_px = 99.0, .compared = 9}});
  ASSERT_EQ(verdicts.size(), 2U);
  EXPECT_EQ(verdicts[0].verdict, Verdict::kDynamicObject);
  EXPECT_EQ(verdicts[1].verdict, Verdict::kStable);
  EXPECT_FALSE(verdicts[1].residual_px.has_value());
}

TEST(FeatureRecognition, GateFlagsAgainstItsOwnThresholdAndClearsNothing) {
  FeatureRecognition recognition{config()};
  static_cast<void>(
      recognition.judge(frame_with({feature(1, kInBox, 2.0), feature(2, kOutside, 2.0)}), person_at_2m()));
  static_cast<void>(
      recognition.judge(frame_with({feature(1, kOutside, 2.0), feature(2, kOutside, 2.0)}), SemanticMask()));
  const auto verdicts = recognition.gate(std::vector<ConsistencyResidual>{
      {.id = 1, .mean_px = 0.0, .compared = 9}, {.id = 2, .mean_px = 8.1, .compared = 1}});
  expect_verdict(verdicts.at(0), Verdict::kDynamicObject, VerdictReason::kHistory);
  expect_verdict(verdicts.at(1), Verdict::kDynamicMotion, VerdictReason::kPredictionResidual);
}

TEST(FeatureRecognition, CheckClearsWhatTheGateSuspectedWrongly) {
  FeatureRecognition recognition{config()};
  static_cast<void>(judge_one(recognition, feature(1, kOutside, 2.0), SemanticMask()));
  static_cast<void>(
      recognition.gate(std::vector{ConsistencyResidual{.id = 1, .mean_px = 20.0, .compared = 4}}));
  expect_verdict(check_one(recognition, 0.5, 4), Verdict::kStable, VerdictReason::kRecycled);
}

TEST(FeatureRecognition, TheFloorDoesNotRewriteHistory) {
  DynamicConfig with_floor = config();
  with_floor.min_stable_features = 1;
  FeatureRecognition recognition{with_floor};
  static_cast<void>(judge_one(recognition, feature(1, kOutside, 2.0), SemanticMask()));
  expect_verdict(check_one(recognition, 20.0, 4), Verdict::kStable, VerdictReason::kFloor);
  expect_verdict(judge_one(recognition, feature(1, kOutside, 2.0), SemanticMask()), Verdict::kDynamicMotion,
                 VerdictReason::kHistory);
}

TEST(FeatureRecognition, RecyclesWhatWasQuietForLongEnough) {
  DynamicConfig patient = config();
  patient.quiet_pictures = 2;
  FeatureRecognition recognition(patient);
  static_cast<void>(judge_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  const std::vector<double> residuals_px = {0.5, 1.5, 0.5, 0.5};  // the second one is not quiet: count anew
  std::vector<std::string_view> verdicts;
  for (const double residual_px : residuals_px) {
    static_cast<void>(judge_one(recognition, feature(1, kOutside, 2.0), {}));
    verdicts.push_back(verdict_name(check_one(recognition, residual_px, 1).verdict));
  }
  EXPECT_EQ(verdicts,
            (std::vector<std::string_view>{"dynamic_object", "dynamic_object", "dynamic_object", "stable"}));
}

TEST(FeatureRecognition, CountsAFeatureWithoutResidualAsQuietOutsideTheMaskOnly) {
  DynamicConfig patient = config();
  patient.quiet_pictures = 1;
  FeatureRecognition recognition(patient);
  static_cast<void>(judge_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  EXPECT_EQ(recognition.check({}).at(0).verdict, Verdict::kDynamicObject);
  static_cast<void>(judge_one(recognition, feature(1, kOutside, 2.0), {}));
  EXPECT_EQ(recognition.check({}).at(0).verdict, Verdict::kStable);
}

TEST(FeatureRecognition, ClearsWhatRestsWhateverItsOlderObservationsSayOutsideTheMaskOnly) {
  FeatureRecognition recognition(config());
  const std::vector<std::int64_t> resting = {1};
  const std::vector slid = {ConsistencyResidual{.id = 1, .mean_px = 25.0, .compared = 6}};
  static_cast<void>(judge_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  expect_verdict(recognition.check(slid, resting).at(0), Verdict::kDynamicObject, VerdictReason::kInsideMask);
  static_cast<void>(judge_one(recognition, feature(1, kOutside, 2.0), {}));
  expect_verdict(recognition.check(slid, {}).at(0), Verdict::kDynamicObject, VerdictReason::kHistory);
  static_cast<void>(judge_one(recognition, feature(1, kOutside, 2.0), {}));
  expect_verdict(recognition.check(slid, resting).at(0), Verdict::kStable, VerdictReason::kRested);
}

}  // namespace
}  // namespace stillpoint
