// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/relative_pose.h"

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>

namespace stillpoint {
namespace {

constexpr int kMinimalSample = 5;
constexpr double kConfidence = 0.999;

/// Points farther away than this are ignored in the selection among the four decompositions (cheirality).
constexpr double kFarthest_baselines = 200.0;

}  // namespace

std::optional<RelativePose> estimate_relative_pose(const std::vector<BearingPair>& pairs, double threshold,
                                                   int min_inliers) {
  if (static_cast<int>(pairs.size()) < std::max(min_inliers, kMinimalSample)) return std::nullopt;
  std::vector<cv::Point2d> first;
  std::vector<cv::Point2d> second;
  for (const BearingPair& pair : pairs) {
    first.emplace_back(pair.first.x(), pair.first.y());
    second.emplace_back(pair.second.x(), pair.second.y());
  }
  const cv::Mat camera = cv::Mat::eye(3, 3, CV_64F);
  cv::Mat mask;
  const cv::Mat essential =
      cv::findEssentialMat(first, second, camera, cv::RANSAC, kConfidence, threshold, mask);
  if (essential.rows != 3 || essential.cols != 3) return std::nullopt;

  cv::Mat rotation;
  cv::Mat translation;
  const int inliers =
      cv::recoverPose(essential, first, second, camera, rotation, translation, kFarthest_baselines, mask);
  if (inliers < min_inliers) return std::nullopt;
  const Eigen::Matrix3d R_second_first =
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.ptr<double>());
  const Pose T_second_first{Eigen::Quaterniond(R_second_first),
                            Eigen::Map<Eigen::Vector3d>(translation.ptr<double>())};
  return RelativePose{T_second_first.inverse(), inliers};
}

}  // namespace stillpoint
