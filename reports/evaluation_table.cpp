// SPDX-License-Identifier: BSD-3-Clause
#include "reports/evaluation_table.h"

#include <set>

#include <fmt/format.h>

#include "eval/io/text_reader.h"

namespace stillpoint {
namespace {

std::string cell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "n/a";
}

std::optional<double> rmse(const std::optional<Statistics>& values) {
  if (!values) return std::nullopt;
  return values->rmse;
}

std::string unit_of(const Evaluation& evaluation) {
  const char* const unit = evaluation.rpe_unit == RpeUnit::kSeconds  ? "s"
                           : evaluation.rpe_unit == RpeUnit::kFrames ? "frames"
                                                                     : "m";
  return fmt::format("{:g} {}", evaluation.rpe_delta, unit);
}

}  // namespace

std::string evaluation_table(const std::vector<EvaluatedRun>& runs, TableStyle style) {
  TableRows rows{{"estimate", "recipe", "pairs", "coverage", "CR", "ATE [m]", "ATE [deg]", "T.RPE [m]",
                  "R.RPE [deg]", "over", "drift [%]"}};
  for (const EvaluatedRun& run : runs) {
    for (const Evaluation& e : run.evaluations) {
      rows.push_back({run.name, e.recipe, std::to_string(e.pairs), cell(e.coverage, 4),
                      cell(e.correct_rate, 4), cell(rmse(e.ate_m), 6), cell(rmse(e.ate_deg), 6),
                      cell(rmse(e.rpe_m), 6), cell(rmse(e.rpe_deg), 6), unit_of(e),
                      cell(e.drift_percent, 3)});
    }
  }
  return format_table(rows, style);
}

std::string comparison_table(const Comparison& comparison, TableStyle style) {
  TableRows rows{{"rank", "estimate", "coverage", "ATE where all have poses [m]", "T.RPE [m/s]",
                  "R.RPE [deg/s]", "own ATE [m]"}};
  int rank = 0;
  for (const ComparedRun& run : comparison.ranking) {
    ++rank;
    rows.push_back({run.failed ? "failed" : std::to_string(rank), run.name, cell(run.coverage, 4),
                    cell(run.common_ate_rmse_m, 6), cell(run.common_rpe_m, 6), cell(run.common_rpe_deg, 6),
                    cell(run.own_ate_rmse_m, 6)});
  }
  return format_table(rows, style);
}

std::string per_pose_csv(const std::vector<EvaluatedRun>& runs) {
  std::string text = "run,recipe,t,translation_m,rotation_deg\n";
  for (const EvaluatedRun& run : runs) {
    for (const Evaluation& evaluation : run.evaluations) {
      for (const PoseError& error : evaluation.per_pose) {
        text += fmt::format("{},{},{},{:.17g},{:.17g}\n", run.name, evaluation.recipe, format_stamp(error.t),
                            error.translation_m, error.rotation_deg);
      }
    }
  }
  return text;
}

std::string explanation_text(const std::vector<EvaluatedRun>& runs) {
  std::string text;
  std::set<std::string> told;
  for (const EvaluatedRun& run : runs) {
    for (const Evaluation& evaluation : run.evaluations) {
      if (told.insert(evaluation.recipe).second) {
        text += fmt::format("{} (version {}): {}\n", evaluation.recipe, evaluation.version, evaluation.text);
      }
    }
  }
  return text;
}

}  // namespace stillpoint
