// SPDX-License-Identifier: BSD-3-Clause
/// The OpenLORIS-Scene metrics of one run on one sequence (Shi et al., ICRA 2020; evaluate.py of its tools).
///
///   correct(k)  = e_k <= max_translation_m and theta_k <= max_rotation_deg   (e_k, theta_k: see ate.h)
///   c           = sum over correct k of min(max_hold_s, t_(k+1) - t_k),  t_(N+1) = t_max
///   CR          = c / (t_max - t_min),  CR-T = c / (t_max - t_1)
///   C_ATE       = RMSE of e_k over correct k
///   reloc score = exp(-(t_1 - t_min) / 60 s) if correct(1), else 0
///
/// t_k: stamps of the N matches; t_min: start of the ground truth; t_max: the later one of the end of the
/// ground truth and t_N.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "eval/metrics/coverage.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint::eval {

struct OpenlorisOptions {
  CorrectRateOptions correct;  ///< thresholds infinite by default, as in the tools
  double max_gap_s = 0.5;      ///< to each ground-truth neighbor
  bool scale = false;          ///< align by Sim(3) instead of SE(3)
};

/// Interval of valid correct poses [s since the start of the ground truth].
struct TrackedSpan {
  double begin_s = 0.0;
  double end_s = 0.0;
};

/// Scores of one sequence. Without matches the errors are absent and the rates are 0.
struct OpenlorisSequenceScore {
  std::size_t poses = 0;             ///< of the estimate, without repeated ones
  std::size_t matches = 0;           ///< poses with ground truth
  std::size_t correct = 0;           ///< correct matches
  std::optional<double> ate_rmse_m;  ///< over all matches
  std::optional<double> aoe_rmse_deg;
  std::optional<double> correct_ate_rmse_m;  ///< C_ATE
  std::optional<double> correct_aoe_rmse_deg;
  double correct_rate = 0.0;  ///< CR
  double tracked_rate = 0.0;  ///< CR-T
  double gt_duration_s = 0.0;
  double tracked_time_s = 0.0;                  ///< t_max - t_1
  double correct_time_s = 0.0;                  ///< c
  std::optional<double> relocalization_time_s;  ///< t_1 - t_min, at least 0
  double relocalization_score = 0.0;
  std::vector<TrackedSpan> tracked_spans;
};

/// @param gt ground truth of the body frame of the estimate
/// @param est poses as in the result file, before the alignment
/// @param S_w_v alignment, see `align_openloris`
/// @param options `scale` has no effect: the alignment is given
[[nodiscard]] OpenlorisSequenceScore score_openloris_sequence(const Trajectory& gt, const Trajectory& est,
                                                              const Similarity& S_w_v,
                                                              const OpenlorisOptions& options = {});

/// Alignment for all sequences of a result file: that of its lowest-numbered sequence with matches, or
/// identity.
/// @param gt by sequence number, of the body frame of the estimate
/// @param est by sequence number
/// @param options `correct` has no effect: all matches are aligned
[[nodiscard]] Similarity align_openloris(const std::map<int, Trajectory>& gt,
                                         const std::map<int, Trajectory>& est,
                                         const OpenlorisOptions& options = {});

}  // namespace stillpoint::eval
