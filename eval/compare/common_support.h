// SPDX-License-Identifier: BSD-3-Clause
/// Several runs on one sequence, compared where all of them have poses.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/trajectory/alignment.h"

namespace stillpoint {

struct NamedRun {
  std::string name;
  Trajectory est;
};

struct CompareOptions {
  Alignment alignment = Alignment::kSe3;
  double max_hold_s = 1.0;    ///< how long a pose stands
  double min_coverage = 0.5;  ///< of the ground truth's time; a run below it has failed
};

/// One run's errors, on all it has and on what every run that did not fail has.
struct ComparedRun {
  std::string name;
  bool failed = false;
  double coverage = 0.0;  ///< share of the ground truth's time
  std::optional<double> own_ate_rmse_m;
  std::optional<double> common_ate_rmse_m;
  std::optional<double> common_rpe_m;  ///< strict, over 1 s; rmse
  std::optional<double> common_rpe_deg;
  std::size_t common_pairs = 0;
};

struct Comparison {
  std::vector<ComparedRun> ranking;  ///< by ATE on the common support; failed runs last, by coverage
  double common_s = 0.0;             ///< time in which all runs that did not fail have a pose
};

/// A run that lost most of its track cannot rank before one that kept it: failed runs stand last, and take no
/// part in the common support. Equal errors keep the order of the input.
[[nodiscard]] Comparison compare_runs(const Trajectory& gt, std::span<const NamedRun> runs,
                                      const CompareOptions& options = {});

}  // namespace stillpoint
