// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/alignment.h"

#include "core/geometry/decompositions.h"

#include <algorithm>
#include <cmath>

namespace stillpoint::eval {
namespace {

constexpr double kRankTolerance = 1e-9;  // of the largest singular value

/// First and second moments of the positions.
struct Moments {
  Eigen::Vector3d mean_gt = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_est = Eigen::Vector3d::Zero();
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();  ///< C [m^2]
  double variance_est = 0.0;                              ///< sigma_e^2 [m^2]
};

Moments moments_of(MatchView matches) {
  Moments moments;
  const double count = static_cast<double>(matches.size());
  for (const MatchedPose& match : matches) {
    moments.mean_gt += match.gt.p;
    moments.mean_est += match.est.p;
  }
  moments.mean_gt /= count;
  moments.mean_est /= count;
  for (const MatchedPose& match : matches) {
    const Eigen::Vector3d gt = match.gt.p - moments.mean_gt;
    const Eigen::Vector3d est = match.est.p - moments.mean_est;
    moments.correlation += gt * est.transpose();
    moments.variance_est += est.squaredNorm();
  }
  moments.correlation /= count;
  moments.variance_est /= count;
  return moments;
}

/// The similarity with t = g~ - s R e~.
Similarity map_means(const Moments& moments, const Eigen::Quaterniond& q_w_v, double scale) {
  return {Pose{q_w_v, moments.mean_gt - q_w_v * (scale * moments.mean_est)}, scale};
}

AlignmentResult fit_rotation(const Moments& moments, bool with_scale) {
  const auto [R_w_v, singular] = closest_rotation(moments.correlation);
  const bool determined = singular(0) > 0.0 && singular(1) > kRankTolerance * singular(0);
  const double scale = with_scale && singular(0) > 0.0 ? singular.sum() / moments.variance_est : 1.0;
  return {map_means(moments, Eigen::Quaterniond(R_w_v).normalized(), scale), determined};
}

AlignmentResult fit_yaw(const Moments& moments) {
  // trace(Rz(a) C^T) = cosine cos a + sine sin a + C_22 is maximal at a = atan2(sine, cosine).
  const Eigen::Matrix3d& c = moments.correlation;
  const double cosine = c(0, 0) + c(1, 1);
  const double sine = c(1, 0) - c(0, 1);
  const bool determined = std::hypot(cosine, sine) > kRankTolerance * c.norm();
  const Eigen::Quaterniond q(
      Eigen::AngleAxisd(determined ? std::atan2(sine, cosine) : 0.0, Eigen::Vector3d::UnitZ()));
  return {map_means(moments, q, 1.0), determined};
}

}  // namespace

AlignmentResult align(MatchView matches, Alignment kind, std::size_t first_n) {
  if (kind == Alignment::kNone) return {Similarity{}, true};
  if (matches.empty()) return {};
  if (kind == Alignment::kFirstPose) {
    return {{matches.front().gt * matches.front().est.inverse()}, true};
  }
  const std::size_t count = first_n == 0 ? matches.size() : std::min(first_n, matches.size());
  const Moments moments = moments_of(matches.first(count));
  if (kind == Alignment::kYaw) return fit_yaw(moments);
  return fit_rotation(moments, kind == Alignment::kSim3);
}

Trajectory move_to_frame(const Trajectory& trajectory, const Pose& T_f_g, const std::string& name) {
  Trajectory moved{.frame = name, .poses = trajectory.poses};
  for (StampedPose& pose : moved.poses) pose.T_w_f = pose.T_w_f * T_f_g;
  return moved;
}

}  // namespace stillpoint::eval
