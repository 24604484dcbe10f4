// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/outlier_rejection.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>

#include "core/base/error.h"

namespace stillpoint {
namespace {

constexpr std::size_t kMinMatches = 8;

std::vector<cv::Point2f> scaled(std::span<const Eigen::Vector2d> bearings, double focal_px) {
  std::vector<cv::Point2f> points;
  points.reserve(bearings.size());
  for (const Eigen::Vector2d& bearing : bearings) {
    points.emplace_back(static_cast<float>(focal_px * bearing.x()),
                        static_cast<float>(focal_px * bearing.y()));
  }
  return points;
}

}  // namespace

std::vector<std::uint8_t> epipolar_inliers(std::span<const Eigen::Vector2d> from,
                                           std::span<const Eigen::Vector2d> to,
                                           const OutlierRejectionSettings& settings) {
  STILLPOINT_CHECK(from.size() == to.size());
  std::vector<std::uint8_t> all(from.size(), 1);
  if (from.size() < kMinMatches) return all;

  std::vector<std::uint8_t> inliers;
  const cv::Mat model =
      cv::findFundamentalMat(scaled(from, settings.focal_px), scaled(to, settings.focal_px), cv::FM_RANSAC,
                             settings.threshold_px, settings.confidence, inliers);
  if (model.empty() || inliers.size() != all.size()) return all;
  const auto fitting =
      static_cast<double>(std::count_if(inliers.begin(), inliers.end(), [](auto in) { return in != 0; }));
  const bool believed = fitting >= settings.min_inlier_share * static_cast<double>(all.size());
  return believed ? inliers : all;
}

}  // namespace stillpoint
