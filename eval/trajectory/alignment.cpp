// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/alignment.h"

#include <Eigen/SVD>

namespace stillpoint {
namespace {

/// Means and the correlation of centred positions.
struct Moments {
  Eigen::Vector3d mean_gt = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_est = Eigen::Vector3d::Zero();
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();  ///< mean of (g - g~)(e - e~)^T [m^2]
};

Moments moments_of(std::span<const MatchedPose> matches) {
  Moments moments;
  const double count = static_cast<double>(matches.size());
  for (const MatchedPose& match : matches) {
    moments.mean_gt += match.gt.p / count;
    moments.mean_est += match.est.p / count;
  }
  for (const MatchedPose& match : matches) {
    moments.correlation +=
        (match.gt.p - moments.mean_gt) * (match.est.p - moments.mean_est).transpose() / count;
  }
  return moments;
}

}  // namespace

AlignmentResult align_se3(std::span<const MatchedPose> matches) {
  constexpr double kRankTolerance = 1e-9;  // of the largest singular value
  AlignmentResult result;
  if (matches.empty()) return result;
  const Moments moments = moments_of(matches);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments.correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  const Eigen::Matrix3d R_w_v = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  Pose& T_w_v = result.S_w_v.T_w_v;
  T_w_v.q = Eigen::Quaterniond(R_w_v).normalized();
  T_w_v.p = moments.mean_gt - T_w_v.q * moments.mean_est;
  const Eigen::Vector3d& singular = svd.singularValues();
  result.determined = singular(0) > 0.0 && singular(1) > kRankTolerance * singular(0);
  return result;
}

}  // namespace stillpoint
