// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text/evaluation_report.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/metrics.h"
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
                           : evaluation.rpe_unit == eval::RpeUnit::kMeters ? "m"
                                                                           : "deg";
  return fmt::format("{:g} {}", evaluation.rpe_delta, unit);
}

}  // namespace

namespace {

/// Marks an RPE of few pairs; CSV has numbers only.
class FewPairs {
 public:
  explicit FewPairs(TableStyle style) : style_(style) {}

  [[nodiscard]] std::string marked(const std::optional<double>& rpe, std::size_t pairs) {
    const bool few = rpe && pairs < eval::kFewRpePairs && style_ != TableStyle::kCsv;
    any_ |= few;
    return cell(rpe, 6) + (few ? "*" : "");
  }

  /// Below the table; empty without a mark.
  [[nodiscard]] std::string note() const {
    if (!any_) return "";
    return fmt::format("{}* RPE of fewer than {} pairs.\n", style_ == TableStyle::kMarkdown ? "\n\\" : "",
                       eval::kFewRpePairs);
  }

 private:
  TableStyle style_;
  bool any_ = false;
};

}  // namespace

std::string evaluation_table(const std::vector<EvaluatedRun>& runs, TableStyle style) {
  TableRows rows{{"estimate", "protocol", "pairs", "coverage", "CR", "ATE [m]", "ATE [deg]", "T.RPE [m]",
                  "R.RPE [deg]", "RPE pairs", "over", "drift [%]"}};
  FewPairs few(style);
  for (const EvaluatedRun& run : runs) {
    for (const eval::Evaluation& e : run.evaluations) {
      rows.push_back({run.name, e.protocol, std::to_string(e.pairs), cell(e.coverage, 4),
                      cell(e.correct_rate, 4), cell(rmse(e.ate_m), 6), cell(rmse(e.ate_deg), 6),
                      few.marked(rmse(e.rpe_m), e.rpe_pairs), few.marked(rmse(e.rpe_deg), e.rpe_pairs),
                      std::to_string(e.rpe_pairs), unit_of(e), cell(e.drift_percent, 3)});
    }
  }
  return format_table(rows, style) + few.note();
}

std::string statistics_table(const std::vector<EvaluatedRun>& runs, TableStyle style) {
  TableRows rows{{"estimate", "protocol", "error", "n", "RMSE", "mean", "std", "median"}};
  for (const int percent : eval::kPercentiles) rows.front().push_back(fmt::format("{} %", percent));
  rows.front().emplace_back("max");
  for (const EvaluatedRun& run : runs) {
    for (const eval::Evaluation& e : run.evaluations) {
      const auto add = [&](const std::string& name, const std::optional<eval::Statistics>& values) {
        if (!values) return;
        std::vector<std::string> row{run.name, e.protocol, name, std::to_string(values->count)};
        for (const double value : {values->rmse, values->mean, values->std, values->median})
          row.push_back(cell(value, 6));
        for (const double value : values->percentiles) row.push_back(cell(value, 6));
        row.push_back(cell(values->max, 6));
        rows.push_back(std::move(row));
      };
      add("ATE [m]", e.ate_m);
      add("ATE [deg]", e.ate_deg);
      add(fmt::format("RPE over {} [m]", unit_of(e)), e.rpe_m);
      add(fmt::format("RPE over {} [deg]", unit_of(e)), e.rpe_deg);
    }
  }
  return format_table(rows, style);
}

std::string covariance_table(const std::vector<EvaluatedRun>& runs, TableStyle style) {
  std::vector<const EvaluatedRun*> claiming;
  for (const EvaluatedRun& run : runs) {
    if (run.covariance) claiming.push_back(&run);
  }
  if (claiming.empty()) return {};
  std::ranges::stable_sort(claiming, {}, [](const EvaluatedRun* run) {
    return std::abs(std::log(std::max(run->covariance->position.nees, 1e-12)));
  });
  TableRows rows{
      {"estimate", "covariance", "poses", "NEES/3", "95 % if consistent", "NLL", "within 3 sigma"}};
  for (const EvaluatedRun* const run : claiming) {
    for (const auto& [name, quality] : {std::pair("position", &run->covariance->position),
                                        std::pair("rotation", &run->covariance->rotation)}) {
      rows.push_back({run->name, name, std::to_string(run->covariance->poses), cell(quality->nees, 3),
                      fmt::format("{:.3f} to {:.3f}", quality->nees_low, quality->nees_high),
                      cell(quality->nll, 3), cell(quality->within_3_sigma, 4)});
    }
  }
  return format_table(rows, style);
}

namespace {

/// Runs with equal errors share the smallest of their ranks ("1, 1, 3").
std::string rank_cell(const eval::Comparison& comparison, std::size_t index) {
  const eval::ComparedRun& run = comparison.ranking[index];
  if (run.failed) return "failed";
  if (!run.common_ate_rmse_m) return "n/a";
  const auto first =
      std::ranges::find(comparison.ranking, run.common_ate_rmse_m, &eval::ComparedRun::common_ate_rmse_m);
  return std::to_string(first - comparison.ranking.begin() + 1);
}

}  // namespace

std::string comparison_table(const eval::Comparison& comparison, TableStyle style) {
  TableRows rows{{"rank", "estimate", "coverage", "ATE on common poses [m]", "T.RPE [m/s]", "R.RPE [deg/s]",
                  "RPE pairs", "ATE on all own poses [m]"}};
  FewPairs few(style);
  for (std::size_t i = 0; i < comparison.ranking.size(); ++i) {
    const eval::ComparedRun& run = comparison.ranking[i];
    rows.push_back({rank_cell(comparison, i), run.name, cell(run.coverage, 4), cell(run.common_ate_rmse_m, 6),
                    few.marked(run.common_rpe_m, run.common_rpe_pairs),
                    few.marked(run.common_rpe_deg, run.common_rpe_pairs),
                    std::to_string(run.common_rpe_pairs), cell(run.own_ate_rmse_m, 6)});
  }
  return format_table(rows, style) + few.note();
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
        text += fmt::format("{},{},{},{:.17g},", run.name, evaluation.protocol, eval::format_stamp(error.t),
                            error.translation_m);
        text += std::isnan(error.rotation_deg) ? "n/a\n" : fmt::format("{:.17g}\n", error.rotation_deg);
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

namespace {

using Json = nlohmann::ordered_json;
namespace metric_id = bench::metric_id;

std::string id(std::string_view metric) { return std::string(metric); }

Json quality_json(const eval::ClaimQuality& quality) {
  return {{"nees_ratio", quality.nees},
          {"nees_ratio_95_percent", {quality.nees_low, quality.nees_high}},
          {"nll", quality.nll},
          {"within_3_sigma", quality.within_3_sigma}};
}

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json statistics_json(const std::optional<eval::Statistics>& values) {
  if (!values) return nullptr;
  Json json{{"count", values->count},   {"rmse", values->rmse}, {"mean", values->mean},
            {"median", values->median}, {"std", values->std},   {"min", values->min},
            {"max", values->max},       {"sse", values->sse}};
  for (std::size_t i = 0; i < eval::kPercentiles.size(); ++i)
    json[fmt::format("percentile_{}", eval::kPercentiles[i])] = values->percentiles[i];
  return json;
}

std::optional<double> rmse_per(const std::optional<eval::Statistics>& values, double delta) {
  if (!values) return std::nullopt;
  return values->rmse / delta;
}

Json alignment_json(const eval::Evaluation& evaluation) {
  const eval::AlignmentResult& alignment = evaluation.alignment;
  const Pose& T = alignment.S_w_v.T_w_v;
  const bool by_positions = evaluation.rotation_source == eval::RotationSource::kPositions;
  return {{"scale", alignment.S_w_v.scale},
          {"translation_m", {T.p.x(), T.p.y(), T.p.z()}},
          {"quaternion_xyzw", {T.q.x(), T.q.y(), T.q.z(), T.q.w()}},
          {"determined", alignment.determined},
          {"rotation", !evaluation.rotation_determined ? "not determined"
                       : by_positions                  ? "positions"
                                                       : "orientations"}};
}

Json segments_json(const std::vector<eval::SegmentErrors>& segments) {
  Json list = Json::array();
  for (const eval::SegmentErrors& segment : segments) {
    list.push_back({{"length_m", segment.length_m},
                    {"translation_m", statistics_json(segment.translation_m)},
                    {"translation_lower_quartile_m", segment.translation_lower_quartile_m},
                    {"translation_upper_quartile_m", segment.translation_upper_quartile_m},
                    {"rotation_deg", statistics_json(segment.rotation_deg)},
                    {"yaw_deg", statistics_json(segment.yaw_deg)},
                    {"dropped", segment.dropped}});
  }
  return list;
}

Json lost_json(const std::vector<eval::TimeSpan>& lost) {
  Json list = Json::array();
  for (const eval::TimeSpan& span : lost) list.push_back({to_seconds(span.begin), to_seconds(span.end)});
  return list;
}

Json run_json(const eval::OpenlorisRun& run) {
  const eval::OpenlorisSequenceScore& score = run.score;
  return {{"poses", score.poses},
          {"matches", score.matches},
          {"correct", score.correct},
          {id(metric_id::kCorrectRate), score.correct_rate},
          {"tracked_rate", score.tracked_rate},
          {id(metric_id::kAte), number(score.ate_rmse_m)},
          {"aoe_rmse_deg", number(score.aoe_rmse_deg)},
          {"correct_ate_rmse_m", number(score.correct_ate_rmse_m)},
          {"correct_aoe_rmse_deg", number(score.correct_aoe_rmse_deg)},
          {id(metric_id::kRpeTranslation), number(rmse_per(run.rpe_m, 1.0))},
          {id(metric_id::kRpeRotation), number(rmse_per(run.rpe_deg, 1.0))},
          {"rpe_dropped", run.rpe_dropped},
          {"gt_duration_s", score.gt_duration_s},
          {"tracked_time_s", score.tracked_time_s},
          {"correct_time_s", score.correct_time_s},
          {"relocalization_time_s", number(score.relocalization_time_s)},
          {"relocalization_score", score.relocalization_score}};
}

Json scene_json(const eval::OpenlorisScene& scene) {
  const eval::OpenlorisSceneScore& score = scene.score;
  Json json{{"sequences", score.sequences},
            {"expected_sequences", score.expected_sequences},
            {"figure_correct_rate", score.figure_correct_rate},
            {"tracked_rate", number(score.tracked_rate)},
            {"weighted_ate_rmse_m", number(score.weighted_ate_rmse_m)},
            {"pooled_ate_rmse_m", number(score.pooled_ate_rmse_m)},
            {id(metric_id::kRpeTranslation), number(score.rpe.trans_rmse_m_per_s)},
            {id(metric_id::kRpeRotation), number(score.rpe.rot_rmse_deg_per_s)},
            {"rpe_pairs", score.rpe.pairs},
            {"rpe_dropped", score.rpe.dropped}};
  for (const auto& [sequence, run] : scene.runs) json["runs"][std::to_string(sequence)] = run_json(run);
  return json;
}

}  // namespace

Json covariance_json(const eval::CovarianceScore& score) {
  return {{"poses", score.poses},
          {"position", quality_json(score.position)},
          {"rotation", quality_json(score.rotation)}};
}

std::string hand_eye_text(const eval::HandEye& found) {
  const auto& [q, p] = found.T_f_g;
  return fmt::format(
      "hand-eye calibration, applied: body of the ground truth at "
      "{:.6f},{:.6f},{:.6f},{:.8f},{:.8f},{:.8f},{:.8f} in that "
      "of the estimate, time offset {:+.5f} s; left are {:.4g} m and {:.3g} deg. The errors above are "
      "smaller by what "
      "was fitted",
      p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w(), found.offset_s, found.position_rmse_m,
      found.rotation_rmse_deg);
}

Json hand_eye_json(const eval::HandEye& found) {
  const auto& [q, p] = found.T_f_g;
  return {{"body_translation_m", {p.x(), p.y(), p.z()}},
          {"body_quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}},
          {"offset_s", found.offset_s},
          {"position_rmse_m", found.position_rmse_m},
          {"rotation_rmse_deg", found.rotation_rmse_deg}};
}

std::string time_offset_text(const eval::TimeOffset& found) {
  return fmt::format("offset {:+.5f} s (ATE {:.6f} m; {:.6f} m without offset)", found.offset_s,
                     found.ate_rmse_m, found.ate_rmse_at_zero_m);
}

Json time_offset_json(const eval::TimeOffset& found) {
  return {{"offset_s", found.offset_s},
          {id(metric_id::kAte), found.ate_rmse_m},
          {"ate_rmse_m_without_offset",
           number(std::isfinite(found.ate_rmse_at_zero_m) ? std::optional(found.ate_rmse_at_zero_m)
                                                          : std::nullopt)}};
}

Json evaluation_json(const eval::Evaluation& evaluation) {
  Json json{{"protocol", evaluation.protocol},
            {"version", evaluation.version},
            {"text", evaluation.text},
            {"gt_poses", evaluation.gt_poses},
            {"est_poses", evaluation.est_poses},
            {"pairs", evaluation.pairs},
            {id(metric_id::kCoverage), number(evaluation.coverage)},
            {id(metric_id::kCorrectRate), number(evaluation.correct_rate)},
            {id(metric_id::kFirstPose), number(evaluation.first_pose_s)},
            {id(metric_id::kAte), number(rmse_per(evaluation.ate_m, 1.0))}};
  if (evaluation.rpe_unit == eval::RpeUnit::kSeconds) {
    json[id(metric_id::kRpeTranslation)] = number(rmse_per(evaluation.rpe_m, evaluation.rpe_delta));
    json[id(metric_id::kRpeRotation)] = number(rmse_per(evaluation.rpe_deg, evaluation.rpe_delta));
  }
  json["ate_m"] = statistics_json(evaluation.ate_m);
  json["ate_deg"] = statistics_json(evaluation.ate_deg);
  json["rpe_pairs"] = evaluation.rpe_pairs;
  json["rpe_delta"] = evaluation.rpe_delta;
  for (const auto& [unit, name] : enum_names(evaluation.rpe_unit)) {
    if (unit == evaluation.rpe_unit) json["rpe_unit"] = name;
  }
  json["rpe_m"] = statistics_json(evaluation.rpe_m);
  json["rpe_deg"] = statistics_json(evaluation.rpe_deg);
  json[id(metric_id::kDrift)] = number(evaluation.drift_percent);
  json["jitter_m"] = number(evaluation.jitter_m);
  json["alignment"] = alignment_json(evaluation);
  json["segments"] = segments_json(evaluation.segments);
  json["lost_s"] = lost_json(evaluation.lost);
  json["notes"] = evaluation.notes;
  return json;
}

Json comparison_json(const eval::Comparison& comparison) {
  Json json{{"common_s", comparison.common_s}, {"ranking", Json::array()}};
  for (const eval::ComparedRun& run : comparison.ranking) {
    json["ranking"].push_back({{"estimate", run.name},
                               {"failed", run.failed},
                               {id(metric_id::kCoverage), run.coverage},
                               {"common_pairs", run.common_pairs},
                               {"common_rpe_pairs", run.common_rpe_pairs},
                               {"common_" + id(metric_id::kAte), number(run.common_ate_rmse_m)},
                               {"common_" + id(metric_id::kRpeTranslation), number(run.common_rpe_m)},
                               {"common_" + id(metric_id::kRpeRotation), number(run.common_rpe_deg)},
                               {"own_" + id(metric_id::kAte), number(run.own_ate_rmse_m)}});
  }
  return json;
}

Json openloris_json(const eval::OpenlorisEvaluation& evaluation) {
  Json json = {{"schema", 1}};
  for (const auto& [system, scenes] : evaluation.benchmark.systems) {
    for (const auto& [name, scene] : scenes) json["systems"][system][name] = scene_json(scene);
  }
  json["skipped"] = evaluation.skipped;
  return json;
}

}  // namespace stillpoint::report
