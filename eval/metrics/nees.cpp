// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/nees.h"

#include <Eigen/Cholesky>

#include <vector>

#include "core/base/error.h"
#include "core/geometry/so3.h"
#include "eval/trajectory/association.h"

namespace stillpoint::eval {
namespace {

constexpr double kConverged_s = 3.0;  // initialization, gravity and biases; as in scripts/nees.sh
constexpr double kMaxTruthGap_s = 0.1;

bool is_positive_definite(const Eigen::Matrix3d& covariance) {
  return Eigen::LLT<Eigen::Matrix3d>(covariance).info() == Eigen::Success;
}

double squared_mahalanobis(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance,
                           const char* quantity) {
  const Eigen::LLT<Eigen::Matrix3d> factor(covariance);
  if (factor.info() != Eigen::Success) {
    throw InputError(std::string(quantity) + " covariance", "is not positive definite");
  }
  return error.dot(factor.solve(error));
}

}  // namespace

Nees nees(const Pose& gt, const Pose& est, const Eigen::Matrix3d& rotation_covariance,
          const Eigen::Matrix3d& position_covariance) {
  const Eigen::Vector3d rotation_error = -log_so3(gt.q * est.q.conjugate());
  return {squared_mahalanobis(rotation_error, rotation_covariance, "rotation"),
          squared_mahalanobis(gt.p - est.p, position_covariance, "position")};
}

std::optional<MeanNees> mean_nees(const Trajectory& gt, std::span<const ClaimedPose> claims) {
  Trajectory located;
  std::vector<const ClaimedPose*> sources;
  for (const ClaimedPose& claim : claims) {
    if (claim.claim != PoseClaim::kLocated || claim.segment != 0) continue;
    located.poses.push_back({.t = claim.t, .T_w_f = claim.T_w_c});
    sources.push_back(&claim);
  }
  const std::vector<InterpolatedPair> pairs = associate_interpolated(gt, located, kMaxTruthGap_s);
  const std::vector<MatchedPose> poses = matched_poses(gt, located, pairs);
  MeanNees sum;
  int count = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const ClaimedPose& claim = *sources[pairs[i].est];
    if (seconds_between(poses.front().t, claim.t) < kConverged_s ||
        !is_positive_definite(claim.position_covariance) ||
        !is_positive_definite(claim.rotation_covariance)) {
      continue;
    }
    const Pose truth = poses.front().est * (poses.front().gt.inverse() * poses[i].gt);
    const Nees frame = nees(truth, poses[i].est, claim.rotation_covariance, claim.position_covariance);
    sum.rotation += frame.rotation / 3.0;
    sum.position += frame.position / 3.0;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return MeanNees{.rotation = sum.rotation / count, .position = sum.position / count};
}

}  // namespace stillpoint::eval
