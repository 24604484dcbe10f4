// SPDX-License-Identifier: BSD-3-Clause
/// The OpenLORIS-Scene metrics of one run on one sequence (Shi et al., ICRA 2020).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "eval/metrics/coverage.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint {

struct OpenlorisOptions {
  CorrectRateOptions correct;  ///< thresholds infinite by default, as in the tools
  double max_gap_s = 0.5;      ///< to either ground-truth neighbour
  bool scale = false;          ///< estimate the scale too
};

/// A stretch of time in which correct poses stand [s since the ground truth's start].
struct TrackedSpan {
  double begin_s = 0.0;
  double end_s = 0.0;
};

/// Scores of one sequence. Without a match the errors are absent and the rates 0.
struct OpenlorisSequenceScore {
  std::size_t poses = 0;    ///< of the estimate, repeated ones left out
  std::size_t matches = 0;  ///< with a ground truth
  std::size_t correct = 0;
  std::optional<double> ate_rmse_m;  ///< over all matches
  std::optional<double> aoe_rmse_deg;
  std::optional<double> correct_ate_rmse_m;  ///< over the correct ones: C_ATE
  std::optional<double> correct_aoe_rmse_deg;
  double correct_rate = 0.0;  ///< correct time / ground truth's time: CR
  double tracked_rate = 0.0;  ///< correct time / time since the first match: CR-T
  double gt_duration_s = 0.0;
  double tracked_time_s = 0.0;  ///< from the first match to the end
  double correct_time_s = 0.0;
  std::optional<double> relocalization_time_s;  ///< from the ground truth's start to the first match
  double relocalization_score = 0.0;            ///< exp(-time / 60 s) if the first match is correct, else 0
  std::vector<TrackedSpan> tracked_spans;
};

/// @param gt ground truth, already of the estimate's frame
/// @param S_w_v alignment, from the first sequence of the estimate's file
[[nodiscard]] OpenlorisSequenceScore score_openloris_sequence(const Trajectory& gt, const Trajectory& est,
                                                              const Similarity& S_w_v,
                                                              const OpenlorisOptions& options = {});

/// The alignment of a result file: by the matches of its lowest sequence that has any, used for all of them.
/// Identity when there is none.
/// @param gt by sequence number, already of the estimate's frame
[[nodiscard]] Similarity align_openloris(const std::map<int, Trajectory>& gt,
                                         const std::map<int, Trajectory>& est,
                                         const OpenlorisOptions& options = {});

}  // namespace stillpoint
