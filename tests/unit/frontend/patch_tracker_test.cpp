// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/patch/patch_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/frontend/detect/feature_detector.h"
#include "core/geometry/so3.h"
#include "tests/unit/frontend/textured_image.h"

namespace stillpoint {
namespace {

constexpr int kLevels = 2;
constexpr int kWindowPx = 21;
const cv::Size kImageSize(320, 240);
const std::vector<cv::Point2f> kPoints = {{100.0F, 60.0F}, {160.0F, 120.0F}, {220.0F, 180.0F}};

ImagePyramid pyramid_of(const cv::Mat& gray) {
  ImagePyramid pyramid;
  pyramid.rebuild(gray, kPatchReach, kLevels, PyramidKind::kImages);
  return pyramid;
}

KltResult track(const cv::Mat& from, const cv::Mat& to, const std::vector<cv::Point2f>& points,
                const std::vector<cv::Point2f>& initial_guesses) {
  return track_points_patch({.from = pyramid_of(from),
                             .to = pyramid_of(to),
                             .points = points,
                             .initial_guesses = initial_guesses,
                             .levels = kLevels},
                            {});
}

/// View of a texture, shifted by `shift_px` to the left.
cv::Mat view(int shift_px) {
  static const cv::Mat texture = random_texture(cv::Size(512, 256), 3);
  return texture(cv::Rect({50 + shift_px, 8}, kImageSize)).clone();
}

TEST(PatchTracker, FindsWholePixelShiftsExactly) {
  const KltResult result = track(view(0), view(3), kPoints, kPoints);
  for (std::size_t i = 0; i < kPoints.size(); ++i) {
    EXPECT_TRUE(result.found[i]);
    EXPECT_LT(cv::norm(result.pixels[i] - (kPoints[i] - cv::Point2f(3.0F, 0.0F))), 0.02);
  }
}

TEST(PatchTracker, IsInvariantToBrightness) {
  const cv::Mat brighter = view(2) + 15.0;
  const KltResult result = track(view(0), brighter, kPoints, kPoints);
  for (std::size_t i = 0; i < kPoints.size(); ++i) {
    EXPECT_TRUE(result.found[i]);
    EXPECT_LT(cv::norm(result.pixels[i] - (kPoints[i] - cv::Point2f(2.0F, 0.0F))), 0.02);
  }
}

TEST(PatchTracker, FindsNothingWithoutTexture) {
  const cv::Mat flat(kImageSize, CV_8UC1, cv::Scalar(100));
  const KltResult result = track(flat, flat, kPoints, kPoints);
  EXPECT_EQ(result.found, (std::vector<std::uint8_t>{0, 0, 0}));
}

TEST(PatchTracker, RejectsMatchesOfLowCorrelation) {
  // 8x8 patches of independent textures practically never correlate by more than 0.8
  const KltResult result = track(view(0), random_texture(kImageSize, 9), kPoints, kPoints);
  EXPECT_EQ(result.found, (std::vector<std::uint8_t>{0, 0, 0}));
}

TEST(PatchTracker, FindsNothingFromGuessesOutsideTheImageOrNan) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<cv::Point2f> initial_guesses = {{-5.0F, 60.0F}, {nan, 120.0F}, {220.0F, 1e9F}};
  const KltResult result = track(view(0), view(0), kPoints, initial_guesses);
  EXPECT_EQ(result.found, (std::vector<std::uint8_t>{0, 0, 0}));
}

TEST(PatchTracker, TracksPatchesInTheImageCorners) {
  const std::vector<cv::Point2f> corners = {{0.0F, 0.0F}, {319.0F, 239.0F}, {319.0F, 0.0F}, {0.0F, 239.0F}};
  const KltResult result = track(view(0), view(0), corners, corners);
  for (std::size_t i = 0; i < corners.size(); ++i) EXPECT_LT(cv::norm(result.pixels[i] - corners[i]), 1e-3);
}

/// Two noisy images of a plane from poses that differ in rotation and translation; the optical flow is known.
struct KnownFlow {
  cv::Mat from;
  cv::Mat to;
  std::vector<cv::Point2f> points;
  std::vector<cv::Point2f> truth;
  std::vector<cv::Point2f> initial_guesses;  // error of 1.5 px in varying directions

  [[nodiscard]] TrackingRequest request(const ImagePyramid& from_pyramid,
                                        const ImagePyramid& to_pyramid) const {
    return {.from = from_pyramid,
            .to = to_pyramid,
            .points = points,
            .initial_guesses = initial_guesses,
            .levels = kLevels};
  }
};

KnownFlow known_flow() {
  const Camera camera = test_camera();
  const TexturedPlane plane(camera, 2.0, 5);
  const Pose T_to_from{exp_so3({0.004, -0.006, 0.02}), {0.01, -0.008, -0.02}};
  KnownFlow flow{.from = plane.gray_at(Pose{}), .to = plane.gray_at(T_to_from)};
  cv::RNG random(4);
  for (cv::Mat* const image : {&flow.from, &flow.to}) {
    cv::Mat noise(image->size(), CV_8SC1);
    random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
    cv::add(*image, noise, *image, cv::noArray(), CV_8UC1);
  }
  FrontendConfig config;
  config.max_features = 150;
  FeatureMask mask;
  mask.clear(flow.from.size());
  flow.points = make_feature_detector(config)->detect(
      {.gray = flow.from, .mask = mask, .tracked = {}, .wanted = 150, .min_distance_px = 20});
  for (std::size_t i = 0; i < flow.points.size(); ++i) {
    const Eigen::Vector2d pixel(static_cast<double>(flow.points[i].x), static_cast<double>(flow.points[i].y));
    const Eigen::Vector2d moved = plane.pixel_in(T_to_from, pixel);
    const double angle = 2.4 * static_cast<double>(i);  // [rad]
    const Eigen::Vector2d error(1.5 * std::cos(angle), 1.5 * std::sin(angle));
    flow.truth.emplace_back(static_cast<float>(moved.x()), static_cast<float>(moved.y()));
    flow.initial_guesses.push_back(flow.truth.back() +
                                   cv::Point2f(static_cast<float>(error.x()), static_cast<float>(error.y())));
  }
  return flow;
}

struct Quality {
  double median_px = 0.0;
  std::size_t correct = 0;  // of those visible in the second image: found within 1 px
};

Quality quality(const KltResult& result, const KnownFlow& flow) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < flow.points.size(); ++i) {
    const double error = cv::norm(result.pixels[i] - flow.truth[i]);
    const bool in_view = cv::Rect2f(0.0F, 0.0F, 639.0F, 479.0F).contains(flow.truth[i]);
    if (in_view && result.found[i] != 0 && error < 1.0) errors.push_back(error);
  }
  std::sort(errors.begin(), errors.end());
  return {errors.at(errors.size() / 2), errors.size()};
}

TEST(PatchTracker, IsAtLeastAsAccurateAsOpenCvOnAKnownFlow) {
  const KnownFlow flow = known_flow();
  ImagePyramid from;
  ImagePyramid to;
  from.rebuild(flow.from, kWindowPx, kLevels);
  to.rebuild(flow.to, kWindowPx, kLevels);
  const Quality opencv = quality(track_points_klt(flow.request(from, to), {}), flow);
  const Quality patch = quality(track_points_patch(flow.request(from, to), {}), flow);
  RecordProperty("opencv_median_px", std::to_string(opencv.median_px));
  RecordProperty("patch_median_px", std::to_string(patch.median_px));
  EXPECT_LE(patch.median_px, opencv.median_px);
  EXPECT_GE(patch.correct, opencv.correct);
}

TEST(PatchTracker, AllInstructionSetsGiveIdenticalResults) {
  const KnownFlow flow = known_flow();
  const ImagePyramid from = pyramid_of(flow.from);
  const ImagePyramid to = pyramid_of(flow.to);
  const KltResult best = track_points_patch(flow.request(from, to), {});
  const KltResult portable = track_points_patch(flow.request(from, to), {}, PatchTarget::kPortable);
  EXPECT_EQ(best.pixels, portable.pixels);
  EXPECT_EQ(best.found, portable.found);
}

}  // namespace
}  // namespace stillpoint
