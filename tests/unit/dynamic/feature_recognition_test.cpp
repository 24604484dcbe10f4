// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/feature_recognition.h"
#include "tests/support/published_config.h"

#include <gtest/gtest.h>

#include <optional>
#include <string_view>
#include <vector>

namespace stillpoint {
namespace {

const cv::Size kSize(100, 80);
constexpr Box kBox{.x_min = 20, .y_min = 10, .x_max = 60, .y_max = 70};
const Eigen::Vector2d kInBox(40.0, 40.0);
const Eigen::Vector2d kOutside(80.0, 40.0);

DynamicConfig config() {
  DynamicConfig config = published_config().dynamic;
  config.box_margin_px = 0.0;
  config.mcc_threshold_px = 5.0;
  config.mcc_min_observations = 3;
  return config;
}

/// Threshold 3 m in kBox: center depth 2 m, no gap to the background: 2 + epsilon.
SemanticMask person_at_2m() {
  const cv::Mat depth(kSize, CV_16UC1, cv::Scalar(2000));
  return SemanticMask(std::vector{kBox}, {.pixels = depth}, kSize, config());
}

/// Infinite threshold in kBox: no valid depth.
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

/// Label of the only feature of a frame.
DynamicLabel classify_one(FeatureRecognition& recognition, const TrackedFeature& tracked,
                          const SemanticMask& mask) {
  return recognition.classify(frame_with({tracked}), mask).at(0);
}

DynamicLabel check_one(FeatureRecognition& recognition, double mean_px, int pair_count) {
  return recognition
      .check(std::vector{ConsistencyResidual{.id = 1, .mean_px = mean_px, .pair_count = pair_count}})
      .at(0);
}

void expect_label(const DynamicLabel& actual, LabelClass label, LabelReason reason) {
  EXPECT_EQ(label_name(actual.label), label_name(label));
  EXPECT_EQ(reason_name(actual.reason), reason_name(reason));
}

TEST(FeatureRecognition, LabelsFeaturesNearerThanTheThresholdAsDynamic) {
  FeatureRecognition recognition{config()};
  expect_label(classify_one(recognition, feature(1, kInBox, 2.9), person_at_2m()), LabelClass::kDynamicObject,
               LabelReason::kInsideMask);
}

TEST(FeatureRecognition, KeepsBackgroundFeaturesInsideTheBoxStable) {
  FeatureRecognition recognition{config()};
  expect_label(classify_one(recognition, feature(1, kInBox, 3.0), person_at_2m()), LabelClass::kStable,
               LabelReason::kNone);
}

TEST(FeatureRecognition, KeepsFeaturesOutsideAllBoxesStable) {
  FeatureRecognition recognition{config()};
  expect_label(classify_one(recognition, feature(1, kOutside, 0.5), person_at_2m()), LabelClass::kStable,
               LabelReason::kNone);
}

TEST(FeatureRecognition, LabelsFeaturesWithoutDepthInsideABoxAsDynamic) {
  FeatureRecognition recognition{config()};
  expect_label(classify_one(recognition, feature(1, kInBox, 0.0), person_at_2m()), LabelClass::kDynamicObject,
               LabelReason::kInsideMask);
}

TEST(FeatureRecognition, CanKeepFeaturesWithoutDepthUnlessTheThresholdIsInfinite) {
  DynamicConfig published_code = config();
  published_code.unmeasured_is_dynamic = false;
  FeatureRecognition recognition{published_code};
  EXPECT_EQ(classify_one(recognition, feature(1, kInBox, 0.0), person_at_2m()).label, LabelClass::kStable);
  EXPECT_EQ(classify_one(recognition, feature(1, kInBox, 0.0), unmeasured_person()).label,
            LabelClass::kDynamicObject);
}

TEST(FeatureRecognition, KeepsTheDynamicLabelOfFeaturesThatLeaveTheMask) {
  FeatureRecognition recognition{config()};
  static_cast<void>(classify_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  for (int i = 0; i < 3; ++i) {
    expect_label(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()),
                 LabelClass::kDynamicObject, LabelReason::kHistory);
  }
}

TEST(FeatureRecognition, RemovesFeaturesThatAreNoLongerTracked) {
  FeatureRecognition recognition{config()};
  static_cast<void>(classify_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  EXPECT_TRUE(recognition.classify(frame_with({}), SemanticMask()).empty());
  EXPECT_EQ(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()).label, LabelClass::kStable);
}

TEST(FeatureRecognition, ResetRemovesAllFeatures) {
  FeatureRecognition recognition{config()};
  static_cast<void>(classify_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  recognition.reset();
  EXPECT_EQ(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()).label, LabelClass::kStable);
}

TEST(FeatureRecognition, KeepsAHistoryPerFeature) {
  FeatureRecognition recognition{config()};
  static_cast<void>(recognition.classify(
      frame_with({feature(1, kOutside, 2.0), feature(2, kInBox, 2.0), feature(5, kInBox, 9.0)}),
      person_at_2m()));
  const auto labels = recognition.classify(
      frame_with({feature(2, kOutside, 2.0), feature(4, kOutside, 2.0), feature(5, kOutside, 2.0)}),
      SemanticMask());
  ASSERT_EQ(labels.size(), 3U);
  EXPECT_EQ(labels[0].label, LabelClass::kDynamicObject);
  EXPECT_EQ(labels[1].label, LabelClass::kStable);
  EXPECT_EQ(labels[2].label, LabelClass::kStable);
}

TEST(FeatureRecognition, TheGateOfAProbabilityUsesTheDistanceInsteadOfPixels) {
  DynamicConfig by_covariance = config();
  by_covariance.gate_probability = 0.99;  // quantile of two degrees of freedom: 9.21
  const auto gate_one = [&](const ConsistencyResidual& residual) {
    FeatureRecognition recognition{by_covariance};
    static_cast<void>(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()));
    return recognition.gate(std::vector{residual}).at(0).label;
  };
  EXPECT_EQ(gate_one({.id = 1, .mean_px = 20.0, .squared_distance = 9.2}), LabelClass::kStable);
  EXPECT_EQ(gate_one({.id = 1, .mean_px = 2.0, .squared_distance = 9.3}), LabelClass::kDynamicMotion);
  // Without a covariance: the threshold of 8 px.
  EXPECT_EQ(gate_one({.id = 1, .mean_px = 20.0}), LabelClass::kDynamicMotion);
  EXPECT_EQ(gate_one({.id = 1, .mean_px = 7.0}), LabelClass::kStable);
}

TEST(FeatureRecognition, CheckLabelsResidualsAboveTheThresholdAsDynamic) {
  FeatureRecognition recognition{config()};
  static_cast<void>(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()));
  const DynamicLabel at_threshold = check_one(recognition, 5.0, 4);
  expect_label(at_threshold, LabelClass::kStable, LabelReason::kNone);
  EXPECT_EQ(at_threshold.residual_px, 5.0);
  expect_label(check_one(recognition, 5.1, 1), LabelClass::kDynamicMotion, LabelReason::kResidual);
  expect_label(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()),
               LabelClass::kDynamicMotion, LabelReason::kHistory);
}

TEST(FeatureRecognition, CheckRecyclesAfterEnoughObservations) {
  FeatureRecognition recognition{config()};
  static_cast<void>(classify_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  static_cast<void>(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()));
  expect_label(check_one(recognition, 1.0, 1), LabelClass::kDynamicObject, LabelReason::kHistory);  // two
  expect_label(check_one(recognition, 1.0, 2), LabelClass::kStable, LabelReason::kRecycled);        // three
  expect_label(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()), LabelClass::kStable,
               LabelReason::kNone);
}

TEST(FeatureRecognition, CheckDoesNotRecycleInsideTheMask) {
  FeatureRecognition recognition{config()};
  static_cast<void>(classify_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  expect_label(check_one(recognition, 0.0, 10), LabelClass::kDynamicObject, LabelReason::kInsideMask);
}

/// Labels of feature 1, inside the mask, before the check of each frame; `others` features are outside.
std::vector<std::string_view> labels_inside_the_mask(const DynamicConfig& with_evidence,
                                                     const std::vector<std::optional<double>>& residuals_px,
                                                     int others = 0) {
  FeatureRecognition recognition{with_evidence};
  std::vector<TrackedFeature> features = {feature(1, kInBox, 2.0)};
  for (int id = 2; id < 2 + others; ++id) features.push_back(feature(id, kOutside, 2.0));
  std::vector<std::string_view> labels;
  for (const std::optional<double>& residual_px : residuals_px) {
    labels.push_back(label_name(recognition.classify(frame_with(features), person_at_2m()).at(0).label));
    std::vector<ConsistencyResidual> residuals;
    if (residual_px) residuals.push_back({.id = 1, .mean_px = *residual_px, .pair_count = 4});
    static_cast<void>(recognition.check(residuals));
  }
  return labels;
}

DynamicConfig with_masked_static_frames(int frames) {
  DynamicConfig with_evidence = config();
  with_evidence.masked_static_frames = frames;
  return with_evidence;
}

TEST(FeatureRecognition, ReadmitsInsideTheMaskAfterEnoughSmallResiduals) {
  // 1.1 px starts the count anew; a frame without a residual does not change it.
  std::vector<std::string_view> expected(9, "dynamic_object");
  expected[6] = expected[7] = "stable";  // after the residuals of frames 2, 4 and 5 (from 0)
  EXPECT_EQ(labels_inside_the_mask(with_masked_static_frames(3),
                                   {0.9, 1.1, 0.9, std::nullopt, 0.9, 0.9, 0.9, 1.1, 0.9}, 1),
            expected);
}

TEST(FeatureRecognition, ReadmitsNoneInsideTheMaskWhileTwoThirdsAreStable) {
  const std::vector<std::optional<double>> residuals_px(10, 0.0);
  const std::vector<std::string_view> excluded(10, "dynamic_object");
  EXPECT_NE(labels_inside_the_mask(with_masked_static_frames(3), residuals_px, 1), excluded);  // 1 of 2
  EXPECT_EQ(labels_inside_the_mask(with_masked_static_frames(3), residuals_px, 2), excluded);  // 2 of 3
}

TEST(FeatureRecognition, TheMaskOfThePaperIgnoresResiduals) {
  const std::vector<std::optional<double>> residuals_px(100, 0.0);
  EXPECT_EQ(labels_inside_the_mask(config(), residuals_px),
            std::vector<std::string_view>(100, "dynamic_object"));
}

TEST(FeatureRecognition, CheckDoesNotChangeFeaturesWithoutResidual) {
  FeatureRecognition recognition{config()};
  static_cast<void>(
      recognition.classify(frame_with({feature(1, kInBox, 2.0), feature(3, kOutside, 2.0)}), person_at_2m()));
  const auto labels =
      recognition.check(std::vector{ConsistencyResidual{.id = 2, .mean_px = 99.0, .pair_count = 9}});
  ASSERT_EQ(labels.size(), 2U);
  EXPECT_EQ(labels[0].label, LabelClass::kDynamicObject);
  EXPECT_EQ(labels[1].label, LabelClass::kStable);
  EXPECT_FALSE(labels[1].residual_px.has_value());
}

TEST(FeatureRecognition, GateUsesItsOwnThresholdAndRecyclesNothing) {
  FeatureRecognition recognition{config()};
  static_cast<void>(
      recognition.classify(frame_with({feature(1, kInBox, 2.0), feature(2, kOutside, 2.0)}), person_at_2m()));
  static_cast<void>(recognition.classify(frame_with({feature(1, kOutside, 2.0), feature(2, kOutside, 2.0)}),
                                         SemanticMask()));
  const auto labels = recognition.gate(std::vector<ConsistencyResidual>{
      {.id = 1, .mean_px = 0.0, .pair_count = 9}, {.id = 2, .mean_px = 10.1, .pair_count = 1}});
  expect_label(labels.at(0), LabelClass::kDynamicObject, LabelReason::kHistory);
  expect_label(labels.at(1), LabelClass::kDynamicMotion, LabelReason::kPredictionResidual);
}

TEST(FeatureRecognition, CheckRecyclesFeaturesThatTheGateRejectedWrongly) {
  FeatureRecognition recognition{config()};
  static_cast<void>(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()));
  static_cast<void>(
      recognition.gate(std::vector{ConsistencyResidual{.id = 1, .mean_px = 20.0, .pair_count = 4}}));
  expect_label(check_one(recognition, 0.5, 4), LabelClass::kStable, LabelReason::kRecycled);
}

TEST(FeatureRecognition, MinimumOfStableFeaturesDoesNotChangeTheHistory) {
  DynamicConfig with_minimum = config();
  with_minimum.min_stable_features = 1;
  FeatureRecognition recognition{with_minimum};
  static_cast<void>(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()));
  expect_label(check_one(recognition, 20.0, 4), LabelClass::kStable, LabelReason::kMinimumKept);
  expect_label(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()),
               LabelClass::kDynamicMotion, LabelReason::kHistory);
}

/// Behind a person who comes in front of the camera, the features that fit the prediction best are on the
/// person.
TEST(FeatureRecognition, KeepsNoMinimumOfFeaturesAtAPredictionWithCovariance) {
  DynamicConfig with_minimum = config();
  with_minimum.min_stable_features = 1;
  with_minimum.gate_probability = 0.99;
  FeatureRecognition recognition{with_minimum};
  static_cast<void>(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()));
  ConsistencyResidual residual{.id = 1, .mean_px = 20.0, .pair_count = 4};
  expect_label(recognition.gate(std::span(&residual, 1)).at(0), LabelClass::kStable,
               LabelReason::kMinimumKept);
  residual.squared_distance = 100.0;
  expect_label(recognition.gate(std::span(&residual, 1)).at(0), LabelClass::kDynamicMotion,
               LabelReason::kPredictionResidual);
  expect_label(check_one(recognition, 20.0, 4), LabelClass::kDynamicMotion, LabelReason::kPredictionResidual);
  static_cast<void>(classify_one(recognition, feature(1, kOutside, 2.0), SemanticMask()));
  expect_label(check_one(recognition, 20.0, 4), LabelClass::kStable, LabelReason::kMinimumKept);
}

TEST(FeatureRecognition, RecyclesAfterEnoughFramesWithASmallResidual) {
  DynamicConfig with_frame_count = config();
  with_frame_count.recycle_min_frames = 2;
  FeatureRecognition recognition(with_frame_count);
  static_cast<void>(classify_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  const std::vector<double> residuals_px = {0.5, 1.5, 0.5, 0.5};  // the second one resets the count
  std::vector<std::string_view> labels;
  for (const double residual_px : residuals_px) {
    static_cast<void>(classify_one(recognition, feature(1, kOutside, 2.0), {}));
    labels.push_back(label_name(check_one(recognition, residual_px, 1).label));
  }
  EXPECT_EQ(labels,
            (std::vector<std::string_view>{"dynamic_object", "dynamic_object", "dynamic_object", "stable"}));
}

TEST(FeatureRecognition, CountsFramesWithoutResidualOutsideTheMaskOnly) {
  DynamicConfig with_frame_count = config();
  with_frame_count.recycle_min_frames = 1;
  FeatureRecognition recognition(with_frame_count);
  static_cast<void>(classify_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  EXPECT_EQ(recognition.check({}).at(0).label, LabelClass::kDynamicObject);
  static_cast<void>(classify_one(recognition, feature(1, kOutside, 2.0), {}));
  EXPECT_EQ(recognition.check({}).at(0).label, LabelClass::kStable);
}

TEST(FeatureRecognition, RecyclesReadmittedFeaturesOutsideTheMaskOnly) {
  FeatureRecognition recognition(config());
  const std::vector<std::int64_t> readmitted = {1};
  const std::vector large_residual = {ConsistencyResidual{.id = 1, .mean_px = 25.0, .pair_count = 6}};
  static_cast<void>(classify_one(recognition, feature(1, kInBox, 2.0), person_at_2m()));
  expect_label(recognition.check(large_residual, readmitted).at(0), LabelClass::kDynamicObject,
               LabelReason::kInsideMask);
  static_cast<void>(classify_one(recognition, feature(1, kOutside, 2.0), {}));
  expect_label(recognition.check(large_residual, {}).at(0), LabelClass::kDynamicObject,
               LabelReason::kHistory);
  static_cast<void>(classify_one(recognition, feature(1, kOutside, 2.0), {}));
  expect_label(recognition.check(large_residual, readmitted).at(0), LabelClass::kStable,
               LabelReason::kStatic);
}

}  // namespace
}  // namespace stillpoint
