// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/moving_consistency.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr double kFocal = 500.0;  // [px]

Pose at_x(double x) { return Pose{Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}}; }

/// Cameras at x = 0, 0.1 and 0.2 m, optical axes along z.
ConsistencyView sideways_motion() {
  return {.T_w_c = {at_x(0.0), at_x(0.1), at_x(0.2)}, .focal_px = kFocal, .features = {}, .observations = {}};
}

/// The only feature of a view.
struct ObservedFeature {
  std::vector<ConsistencyObservation> observations;
  double inverse_depth = 0.0;
};

/// A point observed with depth by the cameras from index `first` on; at `p_w[k]` for camera first + k.
ObservedFeature observed_at(const ConsistencyView& view, int first, const std::vector<Eigen::Vector3d>& p_w) {
  ObservedFeature feature;
  for (std::size_t k = 0; k < p_w.size(); ++k) {
    const int frame = first + static_cast<int>(k);
    const Eigen::Vector3d p_c = view.T_w_c[static_cast<std::size_t>(frame)].inverse() * p_w[k];
    feature.observations.push_back({.frame = frame, .bearing = p_c.hnormalized(), .depth = p_c.z()});
  }
  return feature;
}

ConsistencyView with(ConsistencyView view, const ObservedFeature& feature) {
  view.features = {
      {.id = 7, .inverse_depth = feature.inverse_depth, .first = 0, .count = feature.observations.size()}};
  view.observations = feature.observations;
  return view;
}

std::vector<ConsistencyResidual> residuals_of(const ConsistencyView& view, const ObservedFeature& feature) {
  return consistency_residuals(with(view, feature));
}

TEST(MovingConsistency, AStaticPointHasZeroResidual) {
  ConsistencyView view = sideways_motion();
  view.T_w_c[1].q = exp_so3({0.1, -0.2, 0.05});
  const Eigen::Vector3d static_point(0.3, -0.2, 2.0);
  const auto residuals = residuals_of(view, observed_at(view, 0, {static_point, static_point, static_point}));
  ASSERT_EQ(residuals.size(), 1U);
  EXPECT_EQ(residuals[0].id, 7);
  EXPECT_EQ(residuals[0].pair_count, 2);
  EXPECT_NEAR(residuals[0].mean_px, 0.0, 1e-9);
}

TEST(MovingConsistency, AMovingPointHasTheMeanOfItsDisplacements) {
  const ConsistencyView view = sideways_motion();
  // In the first camera at depth 2: displacements of 0.02 m and 0.06 m are 500 * 0.02 / 2 = 5 px and 15 px.
  const auto residuals =
      residuals_of(view, observed_at(view, 0, {{0.0, 0.0, 2.0}, {0.02, 0.0, 2.0}, {0.0, 0.06, 2.0}}));
  ASSERT_EQ(residuals.size(), 1U);
  EXPECT_NEAR(residuals[0].mean_px, 10.0, 1e-9);
}

TEST(MovingConsistency, TheReferenceIsTheFirstFrameThatObservesTheFeature) {
  const ConsistencyView view = sideways_motion();
  const auto residuals = residuals_of(view, observed_at(view, 1, {{0.1, 0.0, 2.0}, {0.1, 0.02, 2.0}}));
  ASSERT_EQ(residuals.size(), 1U);
  EXPECT_EQ(residuals[0].pair_count, 1);
  EXPECT_NEAR(residuals[0].mean_px, 5.0, 1e-9);
}

TEST(MovingConsistency, UsesTheEstimatedDepthIfNoneWasMeasured) {
  const ConsistencyView view = sideways_motion();
  ObservedFeature feature = observed_at(view, 0, {{0.0, 0.0, 2.0}, {0.0, 0.02, 2.0}, {0.0, 0.06, 2.0}});
  for (ConsistencyObservation& observation : feature.observations) observation.depth = 0.0;
  feature.inverse_depth = 0.5;  // 2 m: same depth in every camera, so as above
  EXPECT_NEAR(residuals_of(view, feature).at(0).mean_px, 10.0, 1e-9);
}

TEST(MovingConsistency, PrefersMeasuredOverEstimatedDepth) {
  const ConsistencyView view = sideways_motion();
  ObservedFeature feature = observed_at(view, 0, {{0.0, 0.0, 2.0}, {0.02, 0.0, 2.0}});
  feature.inverse_depth = 2.0;  // wrong
  EXPECT_NEAR(residuals_of(view, feature).at(0).mean_px, 5.0, 1e-9);
}

TEST(MovingConsistency, OmitsPairsWithoutDepth) {
  const ConsistencyView view = sideways_motion();
  ObservedFeature feature = observed_at(view, 0, {{0.0, 0.0, 2.0}, {0.02, 0.0, 2.0}, {0.06, 0.0, 2.0}});
  feature.observations[2].depth = 0.0;
  const auto residuals = residuals_of(view, feature);
  ASSERT_EQ(residuals.size(), 1U);
  EXPECT_EQ(residuals[0].pair_count, 1);
  EXPECT_NEAR(residuals[0].mean_px, 5.0, 1e-9);
}

TEST(MovingConsistency, HasNoEntryForFeaturesWithoutPairs) {
  const ConsistencyView view = sideways_motion();
  ObservedFeature without_depth = observed_at(view, 0, {{0.0, 0.0, 2.0}, {0.02, 0.0, 2.0}});
  for (ConsistencyObservation& observation : without_depth.observations) observation.depth = 0.0;
  EXPECT_TRUE(residuals_of(view, without_depth).empty());
  EXPECT_TRUE(residuals_of(view, observed_at(view, 0, {{0.0, 0.0, 2.0}})).empty());
}

TEST(MovingConsistency, APointBehindTheReferenceCameraHasAResidualOfTheFocalLength) {
  ConsistencyView view = sideways_motion();
  view.T_w_c[1] = Pose{exp_so3({0.0, M_PI, 0.0}), Eigen::Vector3d::Zero()};  // faces backwards
  ObservedFeature feature;
  feature.observations = {{.frame = 0, .bearing = {0.0, 0.0}, .depth = 2.0},
                          {.frame = 1, .bearing = {0.0, 0.0}, .depth = 2.0}};
  EXPECT_NEAR(residuals_of(view, feature).at(0).mean_px, kFocal, 1e-9);
}

TEST(MovingConsistency, MotionAlongTheRayIsVisibleFromOtherFramesOnly) {
  const ConsistencyView view = sideways_motion();
  // On the axis of camera 0 at 2 m, later at 1 m: x / z = 0 in camera 0 for both. Camera 1 observes it under
  // -0.05 and -0.1.
  EXPECT_NEAR(residuals_of(view, observed_at(view, 0, {{0, 0, 2}, {0, 0, 1}})).at(0).mean_px, 0.0, 1e-9);
  // With camera 1 as reference: 500 * |-0.05 + 0.1| = 25 px.
  EXPECT_NEAR(residuals_of(view, observed_at(view, 1, {{0, 0, 2}, {0, 0, 1}})).at(0).mean_px, 25.0, 1e-9);
}

TEST(GateOnPrediction, UsesTheNewestFrameAsReference) {
  const ConsistencyView view = sideways_motion();
  // Moved by 0.06 m and back: the earlier frames differ from the newest one by 0 px and 15 px.
  const auto residuals = gate_on_prediction(
      with(view, observed_at(view, 0, {{0.0, 0.0, 2.0}, {0.06, 0.0, 2.0}, {0.0, 0.0, 2.0}})));
  ASSERT_EQ(residuals.size(), 1U);
  EXPECT_EQ(residuals[0].pair_count, 2);
  EXPECT_NEAR(residuals[0].mean_px, 7.5, 1e-9);
}

TEST(GateOnPrediction, MeasuresTheMeanDifferenceInItsStandardDeviations) {
  const ConsistencyView view = sideways_motion();
  // In the newest camera at depth 2 and off by 0.02 m, as seen from both earlier frames: 5 px, to the side.
  const ConsistencyView moved =
      with(view, observed_at(view, 0, {{0.2, 0.0, 2.0}, {0.2, 0.0, 2.0}, {0.22, 0.0, 2.0}}));
  EXPECT_FALSE(gate_on_prediction(moved).at(0).squared_distance);
  PredictionError error{.camera = {.T_w_f = view.T_w_c.back()}, .bearing_sigma = 2.0 / kFocal};
  // Variance of the difference without an error of the pose: 2^2 (1 + 1/2) px^2.
  EXPECT_NEAR(*gate_on_prediction(moved, error).at(0).squared_distance, 25.0 / 6.0, 1e-9);
  // 0.04 m along x: 10 px. An error of the pose along the ray does not show there.
  error.camera.covariance(0, 0) = 0.04 * 0.04;
  error.camera.covariance(2, 2) = 1.0;
  EXPECT_NEAR(*gate_on_prediction(moved, error).at(0).squared_distance, 25.0 / 106.0, 1e-2);
}

TEST(GateOnPrediction, APointBehindTheCameraIsInfinitelyFar) {
  ConsistencyView view = sideways_motion();
  view.T_w_c[2] = Pose{exp_so3({0.0, M_PI, 0.0}), Eigen::Vector3d::Zero()};  // faces backwards
  ObservedFeature feature;
  feature.observations = {{.frame = 0, .bearing = {0.0, 0.0}, .depth = 2.0},
                          {.frame = 1, .bearing = {0.0, 0.0}, .depth = 2.0},
                          {.frame = 2, .bearing = {0.0, 0.0}, .depth = 2.0}};
  const PredictionError error{.camera = {.T_w_f = view.T_w_c.back()}, .bearing_sigma = 1.0};
  EXPECT_TRUE(std::isinf(*gate_on_prediction(with(view, feature), error).at(0).squared_distance));
}

TEST(GateOnPrediction, HasNoEntryForFeaturesNotObservedInTheNewestFrame) {
  const ConsistencyView view = sideways_motion();
  EXPECT_TRUE(
      gate_on_prediction(with(view, observed_at(view, 0, {{0.0, 0.0, 2.0}, {0.06, 0.0, 2.0}}))).empty());
}

TEST(GateOnPrediction, NeedsNoDepthInTheNewestFrame) {
  const ConsistencyView view = sideways_motion();
  ObservedFeature feature = observed_at(view, 1, {{0.0, 0.0, 2.0}, {0.0, 0.04, 2.0}});
  feature.observations.back().depth = 0.0;
  EXPECT_NEAR(gate_on_prediction(with(view, feature)).at(0).mean_px, 10.0, 1e-9);  // 500 * 0.04 / 2
}

}  // namespace
}  // namespace stillpoint
