// SPDX-License-Identifier: BSD-3-Clause
/// Comparison of runs on one sequence over the time in which all of them have poses (common support).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/trajectory/alignment.h"

namespace stillpoint::eval {

struct NamedRun {
  std::string name;
  Trajectory est;
};

struct CompareOptions {
  Alignment alignment = Alignment::kSe3;
  double max_hold_s = 1.0;    ///< validity of a pose, see ate.h
  double rpe_delta_s = 1.0;   ///< interval of the relative errors
  double max_gap_s = 0.11;    ///< of interpolated ground truth, to each neighbor
  double min_coverage = 0.5;  ///< runs with a smaller time coverage, or one pose, count as failed
};

/// Errors of one run, over all its poses (own) and over the common support of all runs that did not fail.
struct ComparedRun {
  std::string name;
  bool failed = false;
  double coverage = 0.0;  ///< fraction of the ground truth's duration
  std::optional<double> own_ate_rmse_m;
  std::optional<double> common_ate_rmse_m;
  std::optional<double> common_rpe_m;  ///< RMSE of the strict RPE over `rpe_delta_s`, per second
  std::optional<double> common_rpe_deg;
  std::size_t common_rpe_pairs = 0;
  std::size_t common_pairs = 0;
};

struct Comparison {
  std::vector<ComparedRun> ranking;  ///< by ATE on the common support; failed runs last, by coverage
  double common_s = 0.0;             ///< duration of the common support
};

/// Ranks runs by their ATE over the common support. Failed runs rank last and do not restrict the common
/// support, so that a run that lost track early cannot rank first. Runs with equal errors keep their order;
/// tables give them one rank.
[[nodiscard]] Comparison compare_runs(const Trajectory& gt, std::span<const NamedRun> runs,
                                      const CompareOptions& options = {});

}  // namespace stillpoint::eval
