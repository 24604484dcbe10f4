// SPDX-License-Identifier: BSD-3-Clause
/// Absolute trajectory error: how far the aligned estimate lies from the ground truth. Paper Sec. IV.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "eval/metrics/statistics.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint {

/// Errors of every pair after alignment, in the order of the matches.
struct AteErrors {
  std::vector<double> translation_m;  ///< |S * p_est - p_gt|
  std::vector<double> rotation_deg;   ///< angle of R_est^T R_gt after alignment, in [0, 180]
};

[[nodiscard]] AteErrors ate_errors(std::span<const MatchedPose> matches, const Similarity& S_w_v);

struct AteResult {
  Statistics translation_m;
  Statistics rotation_deg;
  AlignmentResult alignment;
  std::size_t pairs = 0;
};

/// ATE of the TUM RGB-D tools: their association, rigid alignment over all pairs (Sturm et al., IROS 2012).
/// Nothing for fewer than two pairs.
[[nodiscard]] std::optional<AteResult> ate(const Trajectory& gt, const Trajectory& est,
                                           const AssociationOptions& options = {});

/// Angle of a rotation [rad] in [0, pi], exact near 0 and pi where arccos of the trace is not.
[[nodiscard]] double rotation_angle(const Eigen::Quaterniond& q);

}  // namespace stillpoint
