// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/point_tracker.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

Camera distorted_camera() {
  return Camera{.width = 752,
                .height = 480,
                .fx = 458.654,
                .fy = 457.296,
                .cx = 367.215,
                .cy = 248.375,
                .model = CameraModel::kRadialTangential,
                .distortion = {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0}};
}

Track track_at(const Camera& camera, const Eigen::Vector2d& pixel, double depth) {
  Track track;
  track.feature.pixel = pixel;
  track.feature.bearing = camera.unproject(pixel);
  track.known_depth = depth;
  return track;
}

MotionPrior moving_prior() {
  return {.T_ccur_cprev = {exp_so3({0.03, -0.05, 0.1}), {0.1, -0.2, 0.05}},
          .has_rotation = true,
          .has_translation = true};
}

Eigen::Vector2d predict_one(const Track& track, TrackerPrediction kind) {
  const cv::Point2f pixel = predict_pixels({&track, 1}, {moving_prior(), kind}, distorted_camera()).front();
  return {pixel.x, pixel.y};
}

TEST(FeaturePrediction, FullPredictsAPointOfKnownDepth) {
  const Camera camera = distorted_camera();
  const Eigen::Vector3d point_prev(0.4, -0.3, 1.7);
  const Track track = track_at(camera, camera.project(point_prev), point_prev.z());
  const Eigen::Vector2d expected = camera.project(moving_prior().T_ccur_cprev * point_prev);
  EXPECT_LT((predict_one(track, TrackerPrediction::kFull) - expected).norm(), 1e-4);  // float pixels
}

TEST(FeaturePrediction, RotationPredictsPointsAsIfAtInfinity) {
  const Camera camera = distorted_camera();
  const Eigen::Vector3d far_prev(400.0, -300.0, 1700.0);
  const Eigen::Vector2d expected = camera.project(moving_prior().T_ccur_cprev.q * far_prev);
  const Track near = track_at(camera, camera.project(far_prev), 1.7);
  EXPECT_LT((predict_one(near, TrackerPrediction::kRotation) - expected).norm(), 1e-4);
  const Track unmeasured = track_at(camera, camera.project(far_prev), 0.0);
  EXPECT_LT((predict_one(unmeasured, TrackerPrediction::kFull) - expected).norm(), 1e-4);
}

TEST(FeaturePrediction, NoneKeepsTheCurrentPixels) {
  const Track track = track_at(distorted_camera(), {100.5, 50.25}, 1.0);
  EXPECT_EQ(predict_one(track, TrackerPrediction::kNone), Eigen::Vector2d(100.5, 50.25));
}

TEST(FeaturePrediction, APointPredictedBehindTheCameraKeepsItsPixel) {
  const Track track = track_at(distorted_camera(), {100.5, 50.25}, 1.0);
  MotionPrior turned = moving_prior();
  turned.T_ccur_cprev.q = exp_so3({0.0, 3.0, 0.0});
  const cv::Point2f pixel =
      predict_pixels({&track, 1}, {turned, TrackerPrediction::kRotation}, distorted_camera()).front();
  EXPECT_EQ(pixel, cv::Point2f(100.5F, 50.25F));
}

TEST(FeaturePrediction, FallsBackToTheValidPartsOfThePrior) {
  MotionPrior prior = moving_prior();
  EXPECT_EQ(usable_prediction(TrackerPrediction::kFull, prior), TrackerPrediction::kFull);
  EXPECT_EQ(usable_prediction(TrackerPrediction::kRotation, prior), TrackerPrediction::kRotation);
  EXPECT_EQ(usable_prediction(TrackerPrediction::kNone, prior), TrackerPrediction::kNone);
  prior.T_ccur_cprev.p.x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(usable_prediction(TrackerPrediction::kFull, prior), TrackerPrediction::kRotation);
  prior.has_rotation = false;
  EXPECT_EQ(usable_prediction(TrackerPrediction::kFull, prior), TrackerPrediction::kNone);
}

}  // namespace
}  // namespace stillpoint
