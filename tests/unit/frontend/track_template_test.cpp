// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/patch/patch_tracker.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <optional>

#include "tests/unit/frontend/textured_image.h"

namespace stillpoint {
namespace {

const cv::Size kTemplateImage(320, 240);
constexpr AlignmentSettings kSettings{.search = {.min_correlation = 0.9F}, .max_shift_px = 1.0F};
constexpr AlignmentSettings kWide{.search = {.min_correlation = 0.9F}, .max_shift_px = 2.0F};
constexpr PatchPoint kCenter{160.0F, 120.0F};

ImagePyramid pyramid_of(const cv::Mat& gray) {
  ImagePyramid pyramid;
  pyramid.rebuild(gray, kPatchReach, 2, PyramidKind::kImages);
  return pyramid;
}

cv::Mat texture() { return random_texture(kTemplateImage, 3); }

/// The image warped about kCenter: content at an offset d moves to A d + shift.
cv::Mat warped(const cv::Mat& image, const Eigen::Matrix2d& A, const Eigen::Vector2d& shift) {
  const Eigen::Vector2d center(kCenter.x, kCenter.y);
  const Eigen::Vector2d offset = center + shift - A * center;
  const cv::Matx23d map(A(0, 0), A(0, 1), offset.x(), A(1, 0), A(1, 1), offset.y());
  cv::Mat result;
  cv::warpAffine(image, result, map, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  return result;
}

Eigen::Matrix2d similarity(double scale, double angle_rad) {
  return scale * Eigen::Rotation2Dd(angle_rad).toRotationMatrix();
}

TrackTemplate captured() {
  TrackTemplate patch;
  patch.capture(pyramid_of(texture()), kCenter);
  return patch;
}

/// Distance of the aligned match from the true position [px]; infinite if nothing is found.
double alignment_error_px(const Eigen::Matrix2d& A, const Eigen::Vector2d& shift) {
  const std::optional<PatchPoint> found =
      captured().align(pyramid_of(warped(texture(), A, shift)), A.inverse(), kCenter, kWide);
  if (!found) return std::numeric_limits<double>::infinity();
  return (Eigen::Vector2d(found->x - kCenter.x, found->y - kCenter.y) - shift).norm();
}

TEST(TrackTemplate, FindsAShift) {
  EXPECT_LT(alignment_error_px(Eigen::Matrix2d::Identity(), {0.4, -0.3}), 0.03);
}

TEST(TrackTemplate, FindsAWarpedPatch) {
  EXPECT_LT(alignment_error_px(similarity(1.25, 0.1), {0.4, -0.3}), 0.05);
  EXPECT_LT(alignment_error_px(similarity(0.85, -0.5), {0.2, 0.6}), 0.05);
}

TEST(TrackTemplate, FindsNothingBeyondTheLargestShift) {
  const TrackTemplate patch = captured();
  const ImagePyramid shifted = pyramid_of(warped(texture(), Eigen::Matrix2d::Identity(), {1.5, 0.0}));
  EXPECT_FALSE(patch.align(shifted, Eigen::Matrix2d::Identity(), kCenter, kSettings));
  EXPECT_TRUE(patch.align(shifted, Eigen::Matrix2d::Identity(), kCenter, kWide));
}

TEST(TrackTemplate, FindsNothingInAnotherImage) {
  const ImagePyramid other = pyramid_of(random_texture(kTemplateImage, 4));
  EXPECT_FALSE(captured().align(other, Eigen::Matrix2d::Identity(), kCenter, kSettings));
}

TEST(TrackTemplate, RefusesWarpsThatExceedTheTemplate) {
  const ImagePyramid same = pyramid_of(texture());
  EXPECT_FALSE(captured().align(same, similarity(2.0, 0.0), kCenter, kSettings));
  const Eigen::Matrix2d invalid = Eigen::Matrix2d::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(captured().align(same, invalid, kCenter, kSettings));
}

TEST(TrackTemplate, IsEmptyUntilCapturedAndAfterClear) {
  TrackTemplate patch;
  EXPECT_TRUE(patch.empty());
  EXPECT_FALSE(patch.align(pyramid_of(texture()), Eigen::Matrix2d::Identity(), kCenter, kSettings));
  patch.capture(pyramid_of(texture()), kCenter);
  EXPECT_FALSE(patch.empty());
  patch.clear();
  EXPECT_TRUE(patch.empty());
}

TEST(TrackTemplate, WorksAtTheEdgeOfTheImageAndWithOneLevel) {
  ImagePyramid one_level;
  one_level.rebuild(texture(), kPatchReach, 1, PyramidKind::kImages);
  const PatchPoint corner{1.0F, static_cast<float>(kTemplateImage.height) - 2.0F};
  TrackTemplate patch;
  patch.capture(one_level, corner);
  const std::optional<PatchPoint> found =
      patch.align(one_level, Eigen::Matrix2d::Identity(), corner, kSettings);
  ASSERT_TRUE(found);
  EXPECT_LT(std::hypot(found->x - corner.x, found->y - corner.y), 0.01F);
}

}  // namespace
}  // namespace stillpoint
