// SPDX-License-Identifier: BSD-3-Clause
#include "eval/compare/hand_eye.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"
#include "eval/metrics/rpe.h"

namespace stillpoint::eval {
namespace {

constexpr std::size_t kMinHandEyeMatches = 20;
constexpr std::size_t kHandEyePoses = 2000;  ///< of the estimate, at most
constexpr double kInterval_s = 0.5;          ///< of relative motions
constexpr double kMaxOffset_s = 0.5;
constexpr double kOffsetStep_s = 0.02;
constexpr double kOffsetPrecision_s = 1e-5;

/// Every k-th pose, so that the search takes less than a second.
Trajectory hand_eye_sample(const Trajectory& path) {
  const std::size_t step = path.poses.size() / kHandEyePoses + 1;
  Trajectory sample{.frame = path.frame, .poses = {}};
  for (std::size_t i = 0; i < path.poses.size(); i += step) sample.poses.push_back(path.poses[i]);
  return sample;
}

/// Moments of the rotation vectors of relative motions.
struct RotationMoments {
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();  ///< sum of log(E_ij) log(G_ij)^T
  Eigen::Matrix3d truth = Eigen::Matrix3d::Zero();        ///< sum of log(G_ij) log(G_ij)^T
  std::size_t count = 0;
};

RotationMoments rotation_moments(const std::vector<MatchedPose>& matches) {
  RotationMoments moments;
  std::size_t j = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    while (j < matches.size() && seconds_between(matches[i].t, matches[j].t) < kInterval_s) ++j;
    if (j == matches.size()) break;
    if (seconds_between(matches[i].t, matches[j].t) > 2.0 * kInterval_s) continue;
    const Eigen::Vector3d truth = log_so3(matches[i].gt.q.conjugate() * matches[j].gt.q);
    const Eigen::Vector3d est = log_so3(matches[i].est.q.conjugate() * matches[j].est.q);
    moments.correlation += est * truth.transpose();
    moments.truth += truth * truth.transpose();
    ++moments.count;
  }
  return moments;
}

/// Why rotations about fewer than two axes leave the transform open; empty if they do not.
std::string missing_rotation(const RotationMoments& moments) {
  constexpr double kLeastAngle = 2.0 * std::numbers::pi / 180.0;  // RMS over 0.5 s, about the second axis
  if (moments.count < kMinHandEyeMatches) return "too few poses match in time";
  const double middle = std::max(eigenvalues(moments.truth)[1], 0.0);
  const double second = std::sqrt(middle / static_cast<double>(moments.count));
  return second < kLeastAngle ? "the motion turns about fewer than two axes" : "";
}

struct Solution {
  Pose T_f_g;
  double position_rmse_m = 0.0;
  double rotation_rmse = 0.0;  ///< [rad]
  double error = std::numeric_limits<double>::infinity();
};

Solution solve(const std::vector<MatchedPose>& matches, const RotationMoments& moments) {
  const Eigen::Matrix3d R_f_g = closest_rotation(moments.correlation).R;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const MatchedPose& match : matches) sum += match.gt.R() * (match.est.R() * R_f_g).transpose();
  const Eigen::Matrix3d R_w_v = closest_rotation(sum).R;
  Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 3, 6> J;
  J.rightCols<3>().setIdentity();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const MatchedPose& match : matches) {
    J.leftCols<3>() = R_w_v * match.est.R();
    const Eigen::Vector3d residual = match.gt.p - R_w_v * match.est.p;
    H += J.transpose() * J;
    b += J.transpose() * residual;
    mean += match.gt.p;
  }
  const double count = static_cast<double>(matches.size());
  mean /= count;
  const Eigen::Matrix<double, 6, 1> x = solve_symmetric(H, b);
  Solution solution{.T_f_g = {Eigen::Quaterniond(R_f_g), x.head<3>()}};
  double positions = 0.0;
  double rotations = 0.0;
  double extent = 0.0;
  for (const MatchedPose& match : matches) {
    J.leftCols<3>() = R_w_v * match.est.R();
    positions += (match.gt.p - R_w_v * match.est.p - J * x).squaredNorm();
    const Eigen::Matrix3d error = match.gt.R().transpose() * J.leftCols<3>() * R_f_g;
    rotations += log_so3(Eigen::Quaterniond(error).normalized()).squaredNorm();
    extent += (match.gt.p - mean).squaredNorm();
  }
  solution.position_rmse_m = std::sqrt(positions / count);
  solution.rotation_rmse = std::sqrt(rotations / count);
  solution.error = solution.position_rmse_m + solution.rotation_rmse * std::sqrt(extent / count);
  return solution;
}

/// The solution at an offset; an infinite error without enough matches or rotation.
Solution solution_at(const Trajectory& gt, const Trajectory& est, double offset_s) {
  const std::vector<MatchedPose> matches = strict_matches(gt, est, offset_s);
  if (matches.size() < kMinHandEyeMatches) return {};
  const RotationMoments moments = rotation_moments(matches);
  return missing_rotation(moments).empty() ? solve(matches, moments) : Solution{};
}

}  // namespace

HandEye hand_eye(const Trajectory& gt, const Trajectory& whole) {
  constexpr double kGolden = 0.6180339887498949;
  const Trajectory est = hand_eye_sample(whole);
  HandEye result;
  double best_error = std::numeric_limits<double>::infinity();
  for (double offset_s = -kMaxOffset_s; offset_s <= kMaxOffset_s + 1e-9; offset_s += kOffsetStep_s) {
    const Solution solution = solution_at(gt, est, offset_s);
    if (solution.error >= best_error) continue;
    best_error = solution.error;
    result.offset_s = offset_s;
  }
  if (std::isinf(best_error)) {
    const std::vector<MatchedPose> matches = strict_matches(gt, est);
    result.undetermined = missing_rotation(rotation_moments(matches));
    return result;
  }
  double low = result.offset_s - kOffsetStep_s;
  double high = result.offset_s + kOffsetStep_s;
  while (high - low > kOffsetPrecision_s) {
    const double a = high - kGolden * (high - low);
    const double b = low + kGolden * (high - low);
    if (solution_at(gt, est, a).error < solution_at(gt, est, b).error) {
      high = b;
    } else {
      low = a;
    }
  }
  result.offset_s = 0.5 * (low + high);
  const Solution solution = solution_at(gt, est, result.offset_s);
  if (std::isinf(solution.error)) {
    result.undetermined = "beside the best offset, too few poses match or the rotation is too small";
    return result;
  }
  result.T_f_g = solution.T_f_g;
  result.position_rmse_m = solution.position_rmse_m;
  result.rotation_rmse_deg = solution.rotation_rmse * 180.0 / std::numbers::pi;
  if (std::abs(result.offset_s) > kMaxOffset_s - kOffsetStep_s)
    result.undetermined = "the clocks differ by 0.5 s or more; use --find-offset and --offset";
  return result;
}

}  // namespace stillpoint::eval
