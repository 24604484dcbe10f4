// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text/openloris_table.h"

#include <fmt/format.h>

namespace stillpoint::report {
namespace {

std::string cell(const std::optional<double>& value, int decimals, double factor = 1.0) {
  return value ? fmt::format("{:.{}f}", factor * *value, decimals) : "n/a";
}

}  // namespace

std::string openloris_table(const eval::OpenlorisBenchmark& benchmark, TableStyle style) {
  TableRows rows{{"system", "scene", "runs", "figure CR [%]", "CR-T [%]", "weighted ATE [m]",
                  "pooled ATE [m]", "T.RPE [m/s]", "R.RPE [deg/s]", "RPE pairs", "dropped"}};
  for (const auto& [system, scenes] : benchmark.systems) {
    for (const auto& [name, scene] : scenes) {
      const eval::OpenlorisSceneScore& score = scene.score;
      rows.push_back({system, name, fmt::format("{}/{}", score.sequences, score.expected_sequences),
                      cell(score.figure_correct_rate, 1, 100.0), cell(score.tracked_rate, 1, 100.0),
                      cell(score.weighted_ate_rmse_m, 4), cell(score.pooled_ate_rmse_m, 4),
                      cell(score.rpe.trans_rmse_m_per_s, 4), cell(score.rpe.rot_rmse_deg_per_s, 3),
                      std::to_string(score.rpe.pairs), std::to_string(score.rpe.dropped)});
    }
  }
  return format_table(rows, style);
}

}  // namespace stillpoint::report
