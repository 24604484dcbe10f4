// SPDX-License-Identifier: BSD-3-Clause
/// Evaluations of trajectories as tables and per-pose lists.
#pragma once

#include <string>
#include <vector>

#include "eval/compare/common_support.h"
#include "eval/recipes/recipe.h"
#include "reports/text_table.h"

namespace stillpoint {

/// One estimate and what each chosen recipe says about it.
struct EvaluatedRun {
  std::string name;
  Trajectory est;
  std::vector<Evaluation> evaluations;
};

/// A row an estimate and recipe; "n/a" without data. Coverage stands before the errors.
[[nodiscard]] std::string evaluation_table(const std::vector<EvaluatedRun>& runs, TableStyle style);

/// The ranking at the common support.
[[nodiscard]] std::string comparison_table(const Comparison& comparison, TableStyle style);

/// `run,recipe,t,translation_m,rotation_deg`, a row a matched pose.
[[nodiscard]] std::string per_pose_csv(const std::vector<EvaluatedRun>& runs);

/// What each recipe did, and what it dropped or hides.
[[nodiscard]] std::string explanation_text(const std::vector<EvaluatedRun>& runs);

}  // namespace stillpoint
