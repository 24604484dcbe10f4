// SPDX-License-Identifier: BSD-3-Clause
/// Evaluations of trajectories as tables, per-pose lists, and JSON in full precision, where null means no
/// data.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "eval/compare/common_support.h"
#include "eval/compare/hand_eye.h"
#include "eval/compare/time_offset.h"
#include "eval/io/trajectory_file.h"
#include "eval/metrics/consistency.h"
#include "eval/openloris/benchmark.h"
#include "eval/protocols/protocol.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {

/// One estimated trajectory and its evaluation under each chosen protocol. With one pose it has failed.
struct EvaluatedRun {
  std::string name;
  Trajectory est;
  eval::RowRepairs repairs = {};  ///< of the file of the estimate
  std::vector<eval::Evaluation> evaluations;
  std::vector<std::string> warnings = {};  ///< conventions that the estimate seems to violate
  std::optional<eval::CovarianceScore> covariance = std::nullopt;  ///< of estimates that bring covariances
  std::optional<eval::HandEye> hand_eye = std::nullopt;            ///< applied to `est`
  std::optional<eval::TimeOffset> time_offset = std::nullopt;      ///< estimated, not applied
};

/// One row per estimate and protocol; "n/a" without data. Coverage precedes the errors. An RPE of few pairs
/// has an asterisk and a line below the table, but in CSV, whose column "RPE pairs" tells it.
[[nodiscard]] std::string evaluation_table(const std::vector<EvaluatedRun>& runs, TableStyle style);

/// Statistics of the errors of each evaluation: RMSE, mean, standard deviation, median, percentiles, maximum.
[[nodiscard]] std::string statistics_table(const std::vector<EvaluatedRun>& runs, TableStyle style);

/// Two rows per estimate with covariances, the most consistent position first; empty without one.
[[nodiscard]] std::string covariance_table(const std::vector<EvaluatedRun>& runs, TableStyle style);

[[nodiscard]] nlohmann::ordered_json covariance_json(const eval::CovarianceScore& score);

/// Body transform and time offset, and the errors that they leave.
[[nodiscard]] std::string hand_eye_text(const eval::HandEye& found);
[[nodiscard]] nlohmann::ordered_json hand_eye_json(const eval::HandEye& found);

/// The offset, and the ATE with it and without.
[[nodiscard]] std::string time_offset_text(const eval::TimeOffset& found);
[[nodiscard]] nlohmann::ordered_json time_offset_json(const eval::TimeOffset& found);

/// The ranking on the common support; few RPE pairs are marked as in `evaluation_table`.
[[nodiscard]] std::string comparison_table(const eval::Comparison& comparison, TableStyle style);

/// OpenLORIS scores: one row per system and scene; every definition of correct rate and error has a column of
/// its own.
[[nodiscard]] std::string openloris_table(const eval::OpenlorisBenchmark& benchmark, TableStyle style);

/// First line of `per_pose_csv`: `run,protocol,t,translation_m,rotation_deg`.
[[nodiscard]] std::string per_pose_header();

/// The header, and one row per matched pose; n/a: a rotation error that is not determined.
[[nodiscard]] std::string per_pose_csv(const std::vector<EvaluatedRun>& runs);

/// Description of each protocol used: association, alignment, and what it ignores.
[[nodiscard]] std::string explanation_text(const std::vector<EvaluatedRun>& runs);

/// All fields except the per-pose errors.
[[nodiscard]] nlohmann::ordered_json evaluation_json(const eval::Evaluation& evaluation);

[[nodiscard]] nlohmann::ordered_json comparison_json(const eval::Comparison& comparison);

/// system -> scene -> scores, including those of each sequence.
[[nodiscard]] nlohmann::ordered_json openloris_json(const eval::OpenlorisEvaluation& evaluation);

}  // namespace stillpoint::report
