// SPDX-License-Identifier: BSD-3-Clause
/// Absolute trajectory error (ATE): pose errors after alignment (Sturm et al., IROS 2012). Paper Sec. IV.
///
///   e_k     = |S p(E_k) - p(G_k)|                  translation error of pair k [m]
///   theta_k = angle((R_S R(E_k))^T R(G_k))         rotation error of pair k
///   ATE     = sqrt(1/N sum_k e_k^2)
///
/// G_k, E_k: matched poses of ground truth and estimate; p(.), R(.): their translation and rotation; S: the
/// alignment (see alignment.h) with rotation R_S; N: number of pairs.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "eval/metrics/statistics.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint::eval {

/// e_k and theta_k of every pair, in the order of the matches.
struct AteErrors {
  std::vector<double> translation_m;  ///< e_k
  std::vector<double> rotation_deg;   ///< theta_k, in [0, 180]
};

[[nodiscard]] AteErrors ate_errors(std::span<const MatchedPose> matches, const Similarity& S_w_v);

struct AteResult {
  Statistics translation_m;
  Statistics rotation_deg;
  AlignmentResult alignment;
  std::size_t pairs = 0;
};

/// ATE as evaluate_ate.py of the TUM RGB-D benchmark computes it: `associate_tum`, then SE(3) alignment over
/// all pairs.
/// @return nullopt for fewer than two pairs
[[nodiscard]] std::optional<AteResult> ate(const Trajectory& gt, const Trajectory& est,
                                           const AssociationOptions& options = {});

/// Rotation angle [rad] in [0, pi]: 2 atan2(|q_v|, |q_w|). Accurate near 0 and pi, where
/// arccos((trace(R) - 1) / 2) is not.
[[nodiscard]] double rotation_angle(const Eigen::Quaterniond& q);

}  // namespace stillpoint::eval
