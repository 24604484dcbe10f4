// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text/evaluation_table.h"

#include <set>

#include <fmt/format.h>

#include "eval/io/text_reader.h"

namespace stillpoint::report {
namespace {

std::string cell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "n/a";
}

std::string percent_cell(const std::optional<double>& ratio) {
  return ratio ? fmt::format("{:.1f}", 100.0 * *ratio) : "n/a";
}

std::optional<double> rmse(const std::optional<eval::Statistics>& values) {
  if (!values) return std::nullopt;
  return values->rmse;
}

std::string unit_of(const eval::Evaluation& evaluation) {
  const char* const unit = evaluation.rpe_unit == eval::RpeUnit::kSeconds  ? "s"
                           : evaluation.rpe_unit == eval::RpeUnit::kFrames ? "frames"
                                                                           : "m";
  return fmt::format("{:g} {}", evaluation.rpe_delta, unit);
}

}  // namespace

std::string evaluation_table(const std::vector<EvaluatedRun>& runs, TableStyle style) {
  TableRows rows{{"estimate", "protocol", "pairs", "coverage", "CR", "ATE [m]", "ATE [deg]", "T.RPE [m]",
                  "R.RPE [deg]", "over", "drift [%]"}};
  for (const EvaluatedRun& run : runs) {
    for (const eval::Evaluation& e : run.evaluations) {
      rows.push_back({run.name, e.protocol, std::to_string(e.pairs), cell(e.coverage, 4),
                      cell(e.correct_rate, 4), cell(rmse(e.ate_m), 6), cell(rmse(e.ate_deg), 6),
                      cell(rmse(e.rpe_m), 6), cell(rmse(e.rpe_deg), 6), unit_of(e),
                      cell(e.drift_percent, 3)});
    }
  }
  return format_table(rows, style);
}

std::string comparison_table(const eval::Comparison& comparison, TableStyle style) {
  TableRows rows{{"rank", "estimate", "coverage", "ATE on common poses [m]", "T.RPE [m/s]", "R.RPE [deg/s]",
                  "ATE on all own poses [m]"}};
  int rank = 0;
  for (const eval::ComparedRun& run : comparison.ranking) {
    ++rank;
    rows.push_back({run.failed ? "failed" : std::to_string(rank), run.name, cell(run.coverage, 4),
                    cell(run.common_ate_rmse_m, 6), cell(run.common_rpe_m, 6), cell(run.common_rpe_deg, 6),
                    cell(run.own_ate_rmse_m, 6)});
  }
  return format_table(rows, style);
}

std::string openloris_table(const eval::OpenlorisBenchmark& benchmark, TableStyle style) {
  TableRows rows{{"system", "scene", "runs", "figure CR [%]", "CR-T [%]", "weighted ATE [m]",
                  "pooled ATE [m]", "T.RPE [m/s]", "R.RPE [deg/s]", "RPE pairs", "dropped"}};
  for (const auto& [system, scenes] : benchmark.systems) {
    for (const auto& [name, scene] : scenes) {
      const eval::OpenlorisSceneScore& score = scene.score;
      rows.push_back({system, name, fmt::format("{}/{}", score.sequences, score.expected_sequences),
                      percent_cell(score.figure_correct_rate), percent_cell(score.tracked_rate),
                      cell(score.weighted_ate_rmse_m, 4), cell(score.pooled_ate_rmse_m, 4),
                      cell(score.rpe.trans_rmse_m_per_s, 4), cell(score.rpe.rot_rmse_deg_per_s, 3),
                      std::to_string(score.rpe.pairs), std::to_string(score.rpe.dropped)});
    }
  }
  return format_table(rows, style);
}

std::string per_pose_header() { return "run,protocol,t,translation_m,rotation_deg\n"; }

std::string per_pose_csv(const std::vector<EvaluatedRun>& runs) {
  std::string text = per_pose_header();
  for (const EvaluatedRun& run : runs) {
    for (const eval::Evaluation& evaluation : run.evaluations) {
      for (const eval::PoseError& error : evaluation.per_pose) {
        text += fmt::format("{},{},{},{:.17g},{:.17g}\n", run.name, evaluation.protocol,
                            eval::format_stamp(error.t), error.translation_m, error.rotation_deg);
      }
    }
  }
  return text;
}

std::string explanation_text(const std::vector<EvaluatedRun>& runs) {
  std::string text;
  std::set<std::string> explained;
  for (const EvaluatedRun& run : runs) {
    for (const eval::Evaluation& evaluation : run.evaluations) {
      if (explained.insert(evaluation.protocol).second) {
        text +=
            fmt::format("{} (version {}): {}\n", evaluation.protocol, evaluation.version, evaluation.text);
      }
    }
  }
  return text;
}

}  // namespace stillpoint::report
