// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/analysis/eval_results.h"

#include <algorithm>
#include <iostream>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "bench/cli/command_line.h"
#include "bench/model/metrics.h"
#include "bench/model/stored_run.h"
#include "bench/record/result_values.h"
#include "core/base/error.h"
#include "eval/compare/common_support.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {

std::vector<RpeDelta> rpe_deltas(const EvalArguments& arguments) {
  const auto default_unit = enum_of<eval::RpeUnit>("--rpe-unit", arguments.rpe_unit);
  std::vector<RpeDelta> deltas;
  for (const std::string& text : arguments.rpe_deltas) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789.eE+-"), text.size());
    const std::string option = "--rpe-delta " + text;
    const auto value = eval::parse_number(std::string_view(text).substr(0, end));
    if (!value || !(*value >= 1e-6 && *value <= 1e6))
      throw InputError(option,
                       "must be from 1e-06 to 1e+06, not " + text + "; a unit s, f, m or deg may follow");
    deltas.push_back(
        {*value, end == text.size() ? default_unit : enum_of<eval::RpeUnit>(option, text.substr(end))});
  }
  if (deltas.empty()) deltas.push_back({.unit = default_unit});
  return deltas;
}

namespace {

/// Other names of alignments: posyaw of rpg_trajectory_evaluation, origin of evo.
std::string alignment_text(const EvalArguments& arguments) {
  if (arguments.alignment == "posyaw") return "yaw";
  if (arguments.alignment == "origin") return "first_pose";
  return arguments.alignment == kHandEyeAlignment ? "se3" : arguments.alignment;
}

}  // namespace

eval::ProtocolOptions protocol_options(const EvalArguments& arguments) {
  eval::ProtocolOptions options;
  if (!arguments.alignment.empty())
    options.alignment = enum_of<eval::Alignment>("--align", alignment_text(arguments));
  options.align_first_n = static_cast<std::size_t>(arguments.align_first);
  if (arguments.max_difference_s > 0.0) options.max_difference_s = arguments.max_difference_s;
  const RpeDelta first = rpe_deltas(arguments).front();
  options.rpe_delta = first.value;
  options.rpe_unit = first.unit;
  options.offset_s = arguments.offset_s;
  options.per_pose = !arguments.plot.empty() || !arguments.map.empty() || !arguments.per_pose.empty();
  return options;
}

Trajectory shifted_estimate(const EvalArguments& arguments, const report::EvaluatedRun& run) {
  Trajectory shifted = run.est;
  for (StampedPose& pose : shifted.poses) pose.t = after(pose.t, arguments.offset_s);
  return shifted;
}

bool has_failed(const report::EvaluatedRun& run) { return run.est.poses.size() < 2; }

namespace {

using Json = nlohmann::ordered_json;

template <class Enum>
std::string_view name_of(Enum value) {
  for (const auto& [known, name] : enum_names(value)) {
    if (known == value) return name;
  }
  return "?";
}

/// How the comparison follows the options, and which of them it cannot follow.
struct ComparisonSetup {
  eval::CompareOptions options;
  std::vector<std::string> ignored;  ///< options as the user wrote them
};

/// The alignment of --align, or that in the name of the first protocol ("strict:sim3"); the tools of compat:*
/// align with SE(3).
eval::Alignment comparison_alignment(const EvalArguments& arguments) {
  if (const auto chosen = protocol_options(arguments).alignment) return *chosen;
  const std::string& protocol = arguments.protocols.empty() ? "" : arguments.protocols.front();
  for (const auto& [kind, name] : enum_names(eval::Alignment{})) {
    if (protocol == fmt::format("strict:{}", name)) return kind;
  }
  return eval::Alignment::kSe3;
}

ComparisonSetup comparison_setup(const EvalArguments& arguments) {
  ComparisonSetup setup;
  setup.options.alignment = comparison_alignment(arguments);
  if (arguments.max_difference_s > 0.0) setup.options.max_gap_s = arguments.max_difference_s;
  const std::vector<RpeDelta> deltas = rpe_deltas(arguments);
  if (deltas.front().unit == eval::RpeUnit::kSeconds) setup.options.rpe_delta_s = deltas.front().value;
  for (std::size_t k = 0; k < deltas.size(); ++k) {
    if (k == 0 && deltas[k].unit == eval::RpeUnit::kSeconds) continue;
    setup.ignored.push_back(
        fmt::format("--rpe-delta {:g} --rpe-unit {}", deltas[k].value, name_of(deltas[k].unit)));
  }
  if (arguments.align_first > 0)
    setup.ignored.push_back(fmt::format("--align-first {}", arguments.align_first));
  if (setup.options.alignment == eval::Alignment::kYaw) setup.ignored.emplace_back("--level");
  if (!arguments.protocols.empty() && arguments.protocols.front().starts_with("compat:"))
    setup.ignored.push_back("the association of " + arguments.protocols.front());
  return setup;
}

eval::Comparison compare(const EvalArguments& arguments, const Trajectory& gt,
                         const std::vector<report::EvaluatedRun>& runs) {
  std::vector<eval::NamedRun> named;
  named.reserve(runs.size());
  for (const report::EvaluatedRun& run : runs) named.push_back({run.name, shifted_estimate(arguments, run)});
  return eval::compare_runs(gt, named, comparison_setup(arguments).options);
}

std::string comparison_heading(const ComparisonSetup& setup, double common_s) {
  return fmt::format(
      "\nComparison over {:.2f} s for which all successful runs have poses (ground truth interpolated "
      "between "
      "neighbors less than {:g} s away, alignment {}, relative errors over {:g} s{}{}):\n",
      common_s, setup.options.max_gap_s, name_of(setup.options.alignment), setup.options.rpe_delta_s,
      setup.ignored.empty() ? "" : "; not followed: ", fmt::join(setup.ignored, ", "));
}

Json comparison_document(const EvalArguments& arguments, const Trajectory& gt,
                         const std::vector<report::EvaluatedRun>& runs) {
  const ComparisonSetup setup = comparison_setup(arguments);
  Json json = report::comparison_json(compare(arguments, gt, runs));
  json["max_difference_s"] = setup.options.max_gap_s;
  json["alignment"] = name_of(setup.options.alignment);
  json["rpe_delta_s"] = setup.options.rpe_delta_s;
  json["not_followed"] = setup.ignored;
  return json;
}

Json rows_json(const eval::RowRepairs& rows) {
  return {{"skipped", rows.skipped}, {"repeated_stamps", rows.repeated}, {"reordered", rows.reordered}};
}

/// The keys of a result.json, with the values of the first protocol where it has them: they follow its
/// options.
Json top_level_metrics(const EvalArguments& arguments, const Trajectory& gt,
                       const report::EvaluatedRun& run) {
  const eval::ScoreOptions options{.offset_s = arguments.offset_s, .expected_times = {}};
  const eval::Score score = eval::score(gt, run.est, options);
  Json json = metric_members({.scored = ScoredTrajectory{.gt = gt, .est = run.est, .score = score}});
  const eval::Evaluation& first = run.evaluations.front();
  const Json evaluation = report::evaluation_json(first);
  for (const std::string_view id : {metric_id::kAte, metric_id::kRpeTranslation, metric_id::kRpeRotation}) {
    const std::string key(id);
    json[key] = evaluation.contains(key) ? evaluation.at(key) : Json(nullptr);
  }
  json["ate_pairs"] = first.pairs;
  json[std::string(metric_id::kRpePairs)] = first.rpe_pairs;
  const std::string text = fmt::format("{}: {}", first.protocol, first.text);
  json["protocols"]["ate"] = text;
  json["protocols"]["rpe"] =
      fmt::format("{} RPE over {:g} {}.", text, first.rpe_delta, name_of(first.rpe_unit));
  for (const std::string_view id : {metric_id::kCorrectRate, metric_id::kCoverage, metric_id::kFirstPose}) {
    const std::string key(id);
    if (evaluation.at(key).is_null()) continue;
    json[key] = evaluation.at(key);
    json["protocols"][key] = text;
  }
  return json;
}

}  // namespace

nlohmann::ordered_json evaluation_document(const EvalArguments& arguments,
                                           const eval::LoadedTrajectory& truth,
                                           const std::vector<report::EvaluatedRun>& runs) {
  const Trajectory& gt = truth.trajectory;
  Json list = Json::array();
  for (const report::EvaluatedRun& run : runs) {
    Json json = top_level_metrics(arguments, gt, run);
    json["estimate"] = run.name;
    json["status"] = status_name(has_failed(run) ? Outcome::kLost : Outcome::kOk);
    json["rows"] = {{"ground_truth", rows_json(truth.repairs)}, {"estimate", rows_json(run.repairs)}};
    json["warnings"] = run.warnings;
    for (const eval::Evaluation& evaluation : run.evaluations)
      json["evaluations"].push_back(report::evaluation_json(evaluation));
    if (run.hand_eye) json["hand_eye"] = report::hand_eye_json(*run.hand_eye);
    if (run.time_offset) json["time_offset"] = report::time_offset_json(*run.time_offset);
    if (run.covariance) json["covariance"] = report::covariance_json(*run.covariance);
    list.push_back(std::move(json));
  }
  Json json{{"schema", 3}};
  if (list.size() == 1) {
    json.update(list.front());
  } else {
    json["runs"] = std::move(list);
    json["comparison"] = comparison_document(arguments, gt, runs);
  }
  return json;
}

void print_evaluations(const EvalArguments& arguments, const Trajectory& gt,
                       const std::vector<report::EvaluatedRun>& runs) {
  const report::TableStyle style = arguments.csv        ? report::TableStyle::kCsv
                                   : arguments.markdown ? report::TableStyle::kMarkdown
                                                        : report::TableStyle::kText;
  std::cout << report::evaluation_table(runs, style);
  if (arguments.statistics) std::cout << '\n' << report::statistics_table(runs, style);
  for (const report::EvaluatedRun& run : runs) {
    if (run.hand_eye) spdlog::info("{}: {}", run.name, report::hand_eye_text(*run.hand_eye));
  }
  if (const std::string table = report::covariance_table(runs, style); !table.empty()) {
    if (style != report::TableStyle::kCsv) {
      std::cout << fmt::format("\nCovariances from 3 s on ({}):\n", arguments.alignment == "none"
                                                                        ? "in the world of the ground truth"
                                                                        : "relative to the first pose");
    } else {
      std::cout << '\n';
    }
    std::cout << table;
  }
  if (runs.size() > 1 && style != report::TableStyle::kCsv) {
    const eval::Comparison comparison = compare(arguments, gt, runs);
    std::cout << comparison_heading(comparison_setup(arguments), comparison.common_s)
              << report::comparison_table(comparison, style);
  }
  if (arguments.explain) std::cout << '\n' << report::explanation_text(runs);
  for (const report::EvaluatedRun& run : runs) {
    if (!run.time_offset) continue;
    const std::string text = fmt::format("{}: {}\n", run.name, report::time_offset_text(*run.time_offset));
    (style == report::TableStyle::kCsv ? std::cerr : std::cout) << text;
  }
  for (const report::EvaluatedRun& run : runs) {
    for (const eval::Evaluation& evaluation : run.evaluations) {
      for (const std::string& note : evaluation.notes) {
        spdlog::info("{}, {}: {}", run.name, evaluation.protocol, note);
      }
    }
    for (const std::string& warning : run.warnings) spdlog::warn("{}: {}", run.name, warning);
  }
}

}  // namespace stillpoint::bench
