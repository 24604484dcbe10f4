// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text/evaluation_json.h"

#include <nlohmann/json.hpp>

#include "bench/model/metrics.h"

namespace stillpoint::report {
namespace {

using Json = nlohmann::ordered_json;
namespace metric_id = bench::metric_id;

std::string id(std::string_view metric) { return std::string(metric); }

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json statistics_json(const std::optional<eval::Statistics>& values) {
  if (!values) return nullptr;
  return {{"count", values->count},   {"rmse", values->rmse}, {"mean", values->mean},
          {"median", values->median}, {"std", values->std},   {"min", values->min},
          {"max", values->max},       {"sse", values->sse}};
}

std::optional<double> rmse_per(const std::optional<eval::Statistics>& values, double delta) {
  if (!values) return std::nullopt;
  return values->rmse / delta;
}

Json alignment_json(const eval::AlignmentResult& alignment) {
  const Pose& T = alignment.S_w_v.T_w_v;
  return {{"scale", alignment.S_w_v.scale},
          {"translation_m", {T.p.x(), T.p.y(), T.p.z()}},
          {"quaternion_xyzw", {T.q.x(), T.q.y(), T.q.z(), T.q.w()}},
          {"determined", alignment.determined}};
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
  json["rpe_delta"] = evaluation.rpe_delta;
  for (const auto& [unit, name] : enum_names(evaluation.rpe_unit)) {
    if (unit == evaluation.rpe_unit) json["rpe_unit"] = name;
  }
  json["rpe_m"] = statistics_json(evaluation.rpe_m);
  json["rpe_deg"] = statistics_json(evaluation.rpe_deg);
  json[id(metric_id::kDrift)] = number(evaluation.drift_percent);
  json["jitter_m"] = number(evaluation.jitter_m);
  json["alignment"] = alignment_json(evaluation.alignment);
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
                               {"common_" + id(metric_id::kAte), number(run.common_ate_rmse_m)},
                               {"common_" + id(metric_id::kRpeTranslation), number(run.common_rpe_m)},
                               {"common_" + id(metric_id::kRpeRotation), number(run.common_rpe_deg)},
                               {"own_" + id(metric_id::kAte), number(run.own_ate_rmse_m)}});
  }
  return json;
}

Json openloris_json(const eval::OpenlorisEvaluation& evaluation) {
  Json json = Json::object();
  for (const auto& [system, scenes] : evaluation.benchmark.systems) {
    for (const auto& [name, scene] : scenes) json["systems"][system][name] = scene_json(scene);
  }
  json["skipped"] = evaluation.skipped;
  return json;
}

}  // namespace stillpoint::report
