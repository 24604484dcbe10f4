// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/drift_correction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <vector>

#include "core/frontend/feature_tracker.h"
#include "core/geometry/so3.h"
#include "tests/unit/frontend/textured_image.h"

namespace stillpoint {
namespace {

constexpr double kPlaneDistance_m = 2.0;
constexpr int kDriftFrames = 80;
constexpr std::size_t kMinTracks = 40;

/// Approach, sideways motion and rotation about the optical axis.
const Pose kStep{exp_so3({0.0, 0.0, 0.004}), {0.002, 0.001, -0.005}};

FrontendConfig config_of(double min_correlation, bool gyroscope) {
  FrontendConfig config;
  config.drift_min_correlation = min_correlation;
  config.prediction = gyroscope ? TrackerPrediction::kRotation : TrackerPrediction::kNone;
  return config;
}

/// Frame of the plane with its true depth and image noise of 2 grey levels.
Frame noisy_frame(const TexturedPlane& plane, const Pose& T_c_first, int index) {
  Frame frame = plane.frame_at(T_c_first, index);
  cv::RNG random(static_cast<std::uint64_t>(index) + 1);
  cv::Mat noise(frame.gray.size(), CV_16SC1), sum;
  random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
  cv::add(frame.gray, noise, sum, cv::noArray(), CV_16S);
  sum.convertTo(frame.gray, CV_8U);
  frame.depth.setTo(1000.0 * (kPlaneDistance_m + T_c_first.p.z()));
  return frame;
}

/// Median error [px] in the last frame of the features of the first one.
double drift_px(const FrontendConfig& config, bool gyroscope) {
  const TexturedPlane plane(test_camera(), kPlaneDistance_m, 7);
  FeatureTracker tracker(config, test_camera());
  std::map<std::int64_t, Eigen::Vector2d> first;
  TrackedFrame last;
  Pose T_c_first;
  for (int i = 0; i < kDriftFrames; ++i) {
    const MotionPrior prior{.T_ccur_cprev = kStep, .has_rotation = gyroscope};
    last = tracker.track(noisy_frame(plane, T_c_first, i), prior, {.detect = true});
    if (i == 0) {
      for (const TrackedFeature& feature : last.features) first[feature.id] = feature.pixel;
    }
    if (i + 1 < kDriftFrames) T_c_first = kStep * T_c_first;
  }
  std::vector<double> errors;
  for (const TrackedFeature& feature : last.features) {
    const auto start = first.find(feature.id);
    if (start != first.end())
      errors.push_back((feature.pixel - plane.pixel_in(T_c_first, start->second)).norm());
  }
  EXPECT_GE(errors.size(), kMinTracks);
  if (errors.empty()) return std::numeric_limits<double>::infinity();
  std::ranges::nth_element(errors, errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2));
  return errors[errors.size() / 2];
}

TEST(DriftCorrection, ErrorsDoNotAccumulate) {
  const double uncorrected_px = drift_px(config_of(0.0, true), true);
  const double corrected_px = drift_px(config_of(0.9, true), true);
  EXPECT_GT(uncorrected_px, 0.15);
  EXPECT_LT(corrected_px, 0.05);
}

TEST(DriftCorrection, TakesTheRotationFromTheImagesWithoutAGyroscope) {
  EXPECT_LT(drift_px(config_of(0.9, false), false), 0.05);
}

TEST(DriftCorrection, BeginsAViewWhereNoneIs) {
  ImagePyramid pyramid;
  pyramid.rebuild(random_texture(cv::Size(64, 48), 1), kPatchReach, 2, PyramidKind::kImages);
  std::vector<Track> tracks(1);
  tracks[0].feature.pixel = {20.0, 20.0};
  tracks[0].feature.depth = 1.5;
  DriftCorrector::begin_views(pyramid, tracks);
  EXPECT_FALSE(tracks[0].first_view.patch.empty());
  EXPECT_EQ(tracks[0].first_view.depth, 1.5);
  tracks[0].feature.depth = 3.0;
  DriftCorrector::begin_views(pyramid, tracks);
  EXPECT_EQ(tracks[0].first_view.depth, 1.5);
}

}  // namespace
}  // namespace stillpoint
