// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/orientations.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace stillpoint::eval {
namespace {

constexpr double kMaxLineRatio = 0.05;  // of the standard deviations across and along a straight path
constexpr double kExactLineRatio = 1e-6;
constexpr double kMaxStanding = 0.05;  // [m]
constexpr double kNoiseFactor = 3.0;   // of the RMSE; less extension than this is noise

/// Shape of the path of the ground truth, and the error of the aligned positions.
struct PathShape {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< of the largest extension
  double along_m = 0.0;                                  ///< standard deviations
  double across_m = 0.0;
  double rmse_m = 0.0;
};

PathShape shape_of(std::span<const MatchedPose> matches, const Similarity& S_w_v) {
  PathShape shape;
  const double count = static_cast<double>(matches.size());
  for (const MatchedPose& match : matches) shape.mean += match.gt.p / count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double squared = 0.0;
  for (const MatchedPose& match : matches) {
    const Eigen::Vector3d offset = match.gt.p - shape.mean;
    covariance += offset * offset.transpose() / count;
    squared += (S_w_v * match.est.p - match.gt.p).squaredNorm() / count;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);  // increasing eigenvalues
  const Eigen::Vector3d deviations = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  shape.direction = solver.eigenvectors().col(2);
  shape.along_m = deviations(2);
  shape.across_m = deviations(1);
  shape.rmse_m = std::sqrt(squared);
  return shape;
}

RotationSource source_of(const PathShape& shape) {
  const double noise_m = kNoiseFactor * shape.rmse_m;
  if (shape.along_m == 0.0 || (shape.along_m < kMaxStanding && shape.along_m < noise_m))
    return RotationSource::kStanding;
  const bool is_line = shape.across_m < kExactLineRatio * shape.along_m ||
                       (shape.across_m < kMaxLineRatio * shape.along_m && shape.across_m < noise_m);
  return is_line ? RotationSource::kLine : RotationSource::kPositions;
}

Eigen::Vector3d vee(const Eigen::Matrix3d& M) { return {M(2, 1), M(0, 2), M(1, 0)}; }

}  // namespace

CompletedAlignment complete_rotation(std::span<const MatchedPose> matches, const Similarity& S_w_v) {
  CompletedAlignment completed{S_w_v};
  if (matches.empty()) return completed;
  const PathShape shape = shape_of(matches, S_w_v);
  completed.source = source_of(shape);
  if (completed.source == RotationSource::kPositions) return completed;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean_est = Eigen::Vector3d::Zero();
  for (const MatchedPose& match : matches) {
    sum += (match.gt.q * (S_w_v.T_w_v.q * match.est.q).conjugate()).toRotationMatrix();
    mean_est += match.est.p / static_cast<double>(matches.size());
  }
  Eigen::Quaterniond correction;
  if (completed.source == RotationSource::kLine) {
    const Eigen::Vector3d& u = shape.direction;
    const double angle = std::atan2(u.dot(vee(sum - sum.transpose())), sum.trace() - u.dot(sum * u));
    correction = Eigen::Quaterniond(Eigen::AngleAxisd(angle, u));
  } else {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0 ? -1.0 : 1.0;
    const Eigen::Matrix3d R =
        svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
    correction = Eigen::Quaterniond(R);
  }
  Pose& T_w_v = completed.S_w_v.T_w_v;
  const Eigen::Vector3d mapped = S_w_v * mean_est;
  T_w_v.q = (correction * T_w_v.q).normalized();
  T_w_v.p = mapped - T_w_v.q * (S_w_v.scale * mean_est);
  return completed;
}

namespace {

/// Largest rotation from the first pose [deg].
double turn_deg(const Trajectory& trajectory) {
  double largest = 0.0;
  for (const StampedPose& pose : trajectory.poses) {
    const Eigen::Quaterniond turned = trajectory.poses.front().T_w_f.q.conjugate() * pose.T_w_f.q;
    largest = std::max(largest, 2.0 * std::atan2(turned.vec().norm(), std::abs(turned.w())));
  }
  return largest * 180.0 / std::numbers::pi;
}

}  // namespace

std::string missing_orientations(const Trajectory& gt, const Trajectory& est) {
  constexpr double kConstant = 1e-5;  // [deg]
  constexpr double kTurning = 5.0;    // [deg]
  if (gt.poses.size() < 2 || est.poses.size() < 2) return "";
  const double gt_deg = turn_deg(gt);
  const double est_deg = turn_deg(est);
  if (std::min(gt_deg, est_deg) > kConstant || std::max(gt_deg, est_deg) < kTurning) return "";
  return std::string("all orientations of the ") + (gt_deg <= kConstant ? "ground truth" : "estimate") +
         " are equal, but the other file turns: rotation errors, relative errors and the correct rate are "
         "n/a";
}

}  // namespace stillpoint::eval
