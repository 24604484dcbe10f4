// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/ate.h"

#include <cmath>
#include <numbers>

namespace stillpoint::eval {

double rotation_angle(const Eigen::Quaterniond& q) {
  return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

AteErrors ate_errors(std::span<const MatchedPose> matches, const Similarity& S_w_v) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  AteErrors errors;
  errors.translation_m.reserve(matches.size());
  errors.rotation_deg.reserve(matches.size());
  for (const MatchedPose& match : matches) {
    const Pose aligned = S_w_v * match.est;
    errors.translation_m.push_back((aligned.p - match.gt.p).norm());
    errors.rotation_deg.push_back(kDegrees * rotation_angle(aligned.q.conjugate() * match.gt.q));
  }
  return errors;
}

std::optional<AteResult> ate(const Trajectory& gt, const Trajectory& est, const AssociationOptions& options) {
  const std::vector<MatchedPose> matches = matched_poses(gt, est, associate_tum(gt, est, options));
  if (matches.size() < 2) return std::nullopt;
  const AlignmentResult alignment = align(matches, Alignment::kSe3);
  const AteErrors errors = ate_errors(matches, alignment.S_w_v);
  return AteResult{.translation_m = *statistics(errors.translation_m),
                   .rotation_deg = *statistics(errors.rotation_deg),
                   .alignment = alignment,
                   .pairs = matches.size()};
}

}  // namespace stillpoint::eval
