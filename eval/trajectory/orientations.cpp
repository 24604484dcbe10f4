// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/orientations.h"

#include "core/geometry/decompositions.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace stillpoint::eval {
namespace {

constexpr double kMaxLineRatio = 0.05;  // of the standard deviations across and along a straight path
constexpr double kExactLineRatio = 1e-6;
constexpr double kMaxStanding = 0.05;        // [m]
constexpr double kNoiseFactor = 3.0;         // of the RMSE; less extension than this is noise
constexpr double kMinMeanCosine = 0.5;       // of the angles between orientations that agree
constexpr double kMinPathCorrelation = 0.5;  // of positions that tell a rotation

/// Extension of a path along and across its direction: standard deviations.
struct PathShape {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  double along_m = 0.0;
  double across_m = 0.0;
};

/// @param vertical the direction is the vertical one instead of that of the largest extension
PathShape shape_of(const Eigen::Matrix3d& covariance, bool vertical) {
  const auto deviation = [](double variance) { return std::sqrt(std::max(variance, 0.0)); };
  if (vertical) {
    const Eigen::Matrix2d horizontal = covariance.topLeftCorner<2, 2>();
    return {Eigen::Vector3d::UnitZ(), deviation(covariance(2, 2)), deviation(eigenvalues(horizontal)(1))};
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);  // increasing eigenvalues
  return {solver.eigenvectors().col(2), deviation(solver.eigenvalues()(2)),
          deviation(solver.eigenvalues()(1))};
}

/// Aligned positions: mean of the estimate, covariances of both paths, RMS of their distance.
struct PathMoments {
  Eigen::Vector3d mean_est = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_gt = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d covariance_est = Eigen::Matrix3d::Zero();
  double rmse_m = 0.0;
  double correlation = 0.0;  ///< of the aligned positions
};

PathMoments moments_of(MatchView matches, const Similarity& S_w_v) {
  PathMoments moments;
  const double count = static_cast<double>(matches.size());
  Eigen::Vector3d mean_gt = Eigen::Vector3d::Zero();
  for (const MatchedPose& match : matches) {
    mean_gt += match.gt.p;
    moments.mean_est += S_w_v * match.est.p;
  }
  mean_gt /= count;
  moments.mean_est /= count;
  double squared = 0.0;
  double product = 0.0;
  for (const MatchedPose& match : matches) {
    const Eigen::Vector3d mapped = S_w_v * match.est.p;
    const Eigen::Vector3d gt = match.gt.p - mean_gt;
    const Eigen::Vector3d est = mapped - moments.mean_est;
    moments.covariance_gt += gt * gt.transpose();
    moments.covariance_est += est * est.transpose();
    squared += (mapped - match.gt.p).squaredNorm();
    product += gt.dot(est) / count;
  }
  moments.covariance_gt /= count;
  moments.covariance_est /= count;
  moments.rmse_m = std::sqrt(squared / count);
  const double scale = std::sqrt(moments.covariance_gt.trace() * moments.covariance_est.trace());
  moments.correlation = scale > 0.0 ? product / scale : 0.0;
  return moments;
}

bool is_exact_line(const PathShape& shape) { return shape.across_m < kExactLineRatio * shape.along_m; }

/// @param gt, est shapes of the two paths; noise is told by that of the ground truth, since the estimate may
/// have another scale
RotationSource source_of(const PathMoments& moments, const PathShape& gt, const PathShape& est) {
  const double noise_m = kNoiseFactor * moments.rmse_m;
  const double extension_m = std::max(gt.along_m, gt.across_m);
  if (extension_m < kMaxStanding && extension_m < noise_m) return RotationSource::kStanding;
  if (moments.correlation < kMinPathCorrelation) return RotationSource::kUnlikePath;
  const bool is_line = is_exact_line(gt) || is_exact_line(est) ||
                       (gt.across_m < kMaxLineRatio * gt.along_m && gt.across_m < noise_m);
  return is_line ? RotationSource::kLine : RotationSource::kPositions;
}

Eigen::Vector3d vee(const Eigen::Matrix3d& M) { return {M(2, 1), M(0, 2), M(1, 0)}; }

/// A rotation, and the mean cosine of the angles between it and the rotations that it was fitted to.
struct FittedRotation {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  double mean_cosine = 0.0;
};

/// @param mean mean of D_i
/// @param axis u
FittedRotation fit_about(const Eigen::Matrix3d& mean, const Eigen::Vector3d& axis) {
  const double sine = axis.dot(vee(mean - mean.transpose()));
  const double cosine = mean.trace() - axis.dot(mean * axis);
  const Eigen::AngleAxisd rotation(std::atan2(sine, cosine), axis);
  return {rotation.toRotationMatrix(), 0.5 * std::hypot(sine, cosine)};
}

FittedRotation fit_freely(const Eigen::Matrix3d& mean) {
  const ClosestRotation fit = closest_rotation(mean);
  return {fit.R, 0.5 * (fit.singular.sum() - 1.0)};
}

}  // namespace

CompletedAlignment complete_rotation(MatchView matches, const Similarity& S_w_v, Alignment kind) {
  CompletedAlignment completed{S_w_v};
  if (matches.empty() || kind == Alignment::kNone || kind == Alignment::kFirstPose) return completed;
  const bool yaw = kind == Alignment::kYaw;
  const PathMoments moments = moments_of(matches, S_w_v);
  const PathShape gt = shape_of(moments.covariance_gt, yaw);
  const PathShape est = shape_of(moments.covariance_est, yaw);
  completed.source = source_of(moments, gt, est);
  if (completed.source == RotationSource::kPositions) return completed;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const MatchedPose& match : matches)
    sum += (match.gt.q * (S_w_v.T_w_v.q * match.est.q).conjugate()).toRotationMatrix();
  const Eigen::Matrix3d mean = sum / static_cast<double>(matches.size());
  const FittedRotation fitted = completed.source == RotationSource::kLine || yaw
                                    ? fit_about(mean, is_exact_line(est) ? est.direction : gt.direction)
                                    : fit_freely(mean);
  if (fitted.mean_cosine < kMinMeanCosine) {
    completed.determined = false;
    return completed;
  }
  Pose& T_w_v = completed.S_w_v.T_w_v;
  const Eigen::Quaterniond correction(fitted.R);
  T_w_v.p = correction * (S_w_v.T_w_v.p - moments.mean_est) + moments.mean_est;
  T_w_v.q = (correction * T_w_v.q).normalized();
  return completed;
}

namespace {

/// Largest rotation from the first pose [deg], or the first one of at least `enough_deg`.
double turn_deg(const Trajectory& trajectory, double enough_deg) {
  double largest = 0.0;
  for (const StampedPose& pose : trajectory.poses) {
    const Eigen::Quaterniond turned = trajectory.poses.front().T_w_f.q.conjugate() * pose.T_w_f.q;
    const double turn = 2.0 * std::atan2(turned.vec().norm(), std::abs(turned.w()));
    largest = std::max(largest, turn * 180.0 / std::numbers::pi);
    if (largest >= enough_deg) break;
  }
  return largest;
}

/// RMS of the rotations between aligned poses [deg]; 0 without matches.
double difference_deg_of(const Trajectory& gt, const Trajectory& est, double offset_s) {
  constexpr double kMaxGap = 0.5;  // [s], to each neighbor
  const PoseMatches pairs(gt, est, associate_interpolated(gt, est, kMaxGap, offset_s));
  const MatchView matches = pairs;
  if (matches.size() < 2) return 0.0;
  const Similarity S_w_v = complete_rotation(matches, align(matches, Alignment::kSe3).S_w_v).S_w_v;
  double squared = 0.0;
  for (const MatchedPose& match : matches)
    squared += std::pow(match.gt.q.angularDistance(S_w_v.T_w_v.q * match.est.q), 2);
  return std::sqrt(squared / static_cast<double>(matches.size())) * 180.0 / std::numbers::pi;
}

}  // namespace

std::string missing_orientations(const Trajectory& gt, const Trajectory& est, double offset_s) {
  constexpr double kConstant = 1e-5;  // [deg]
  constexpr double kTurning = 5.0;    // [deg]
  if (gt.poses.size() < 2 || est.poses.size() < 2) return "";
  const double gt_deg = turn_deg(gt, kTurning);
  const double est_deg = turn_deg(est, kTurning);
  if (std::min(gt_deg, est_deg) > kConstant) return "";
  std::string disagreement = "the other file turns";
  if (std::max(gt_deg, est_deg) < kTurning) {
    const double difference_deg = difference_deg_of(gt, est, offset_s);
    if (difference_deg < kTurning) return "";
    char text[80];
    std::snprintf(text, sizeof text, "those of the other file differ by %.1f deg after alignment",
                  difference_deg);
    disagreement = text;
  }
  return std::string("all orientations of the ") + (gt_deg <= kConstant ? "ground truth" : "estimate") +
         " are equal, but " + disagreement +
         ": rotation errors, relative errors and the correct rate are n/a";
}

}  // namespace stillpoint::eval
