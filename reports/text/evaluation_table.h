// SPDX-License-Identifier: BSD-3-Clause
/// Evaluations of trajectories as tables and per-pose lists.
#pragma once

#include <string>
#include <vector>

#include "eval/compare/common_support.h"
#include "eval/io/trajectory_file.h"
#include "eval/openloris/scene_score.h"
#include "eval/protocols/protocol.h"
#include "reports/tables/text_table.h"

namespace stillpoint::report {

/// One estimated trajectory and its evaluation under each chosen protocol.
struct EvaluatedRun {
  std::string name;
  Trajectory est;
  eval::RowRepairs repairs = {};  ///< of the file of the estimate
  std::vector<eval::Evaluation> evaluations;
};

/// One row per estimate and protocol; "n/a" without data. Coverage precedes the errors.
[[nodiscard]] std::string evaluation_table(const std::vector<EvaluatedRun>& runs, TableStyle style);

/// The ranking on the common support.
[[nodiscard]] std::string comparison_table(const eval::Comparison& comparison, TableStyle style);

/// OpenLORIS scores: one row per system and scene; every definition of correct rate and error has a column of
/// its own.
[[nodiscard]] std::string openloris_table(const eval::OpenlorisBenchmark& benchmark, TableStyle style);

/// First line of `per_pose_csv`: `run,protocol,t,translation_m,rotation_deg`.
[[nodiscard]] std::string per_pose_header();

/// The header, and one row per matched pose.
[[nodiscard]] std::string per_pose_csv(const std::vector<EvaluatedRun>& runs);

/// Description of each protocol used: association, alignment, and what it ignores.
[[nodiscard]] std::string explanation_text(const std::vector<EvaluatedRun>& runs);

}  // namespace stillpoint::report
