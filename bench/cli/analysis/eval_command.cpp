// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint eval`: evaluates trajectory files.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "bench/cli/analysis/pose_files.h"
#include "bench/cli/command_line.h"
#include "bench/model/metrics.h"
#include "bench/model/stored_run.h"
#include "bench/record/output_folder.h"
#include "bench/record/result_values.h"
#include "core/base/error.h"
#include "datasets/bags/bag_geometry.h"
#include "eval/compare/conventions.h"
#include "eval/compare/time_offset.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"
#include "eval/protocols/protocol.h"
#include "eval/trajectory/association.h"
#include "reports/drawing/drawing.h"
#include "reports/drawing/trajectory_plot.h"
#include "reports/text/evaluation_report.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kPlotPixelsPerUnit = 1.5;  // of PNG files

struct EvalArguments {
  PoseFilePaths files;
  std::vector<std::string> protocols;
  std::string alignment;
  int align_first = 0;
  double rpe_delta = 1.0;
  std::string rpe_unit = "s";
  double offset_s = 0.0;
  double max_difference_s = 0.0;
  std::string level;
  bool find_offset = false;
  bool explain = false;
  bool json = false;
  bool csv = false;
  bool markdown = false;
  std::string plot;
  std::string map;
  std::string per_pose;
  bool force = false;
};

eval::ProtocolOptions protocol_options(const EvalArguments& arguments) {
  eval::ProtocolOptions options;
  if (!arguments.alignment.empty())
    options.alignment = enum_of<eval::Alignment>("--align", arguments.alignment);
  options.align_first_n = static_cast<std::size_t>(arguments.align_first);
  if (arguments.max_difference_s > 0.0) options.max_difference_s = arguments.max_difference_s;
  options.rpe_delta = arguments.rpe_delta;
  options.rpe_unit = enum_of<eval::RpeUnit>("--rpe-unit", arguments.rpe_unit);
  options.offset_s = arguments.offset_s;
  options.per_pose = !arguments.plot.empty() || !arguments.map.empty() || !arguments.per_pose.empty();
  return options;
}

/// The poses with their covariances; nullopt without any.
std::optional<eval::CovarianceScore> covariance_score_of(const EvalArguments& arguments, const Trajectory& gt,
                                                         const PoseFile& file) {
  if (!file.covariances) return std::nullopt;
  const Trajectory& est = file.loaded.trajectory;
  const std::vector<eval::StampedCovariance> rows = eval::at_poses(est, *file.covariances);
  std::vector<eval::ClaimedPose> claims;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    claims.push_back({.t = after(est.poses[i].t, arguments.offset_s),
                      .T_w_c = est.poses[i].T_w_f,
                      .claim = eval::PoseClaim::kLocated,
                      .position_covariance = rows[i].position,
                      .rotation_covariance = rows[i].rotation});
  }
  const auto origin =
      arguments.alignment == "none" ? eval::ClaimOrigin::kWorld : eval::ClaimOrigin::kFirstPose;
  const auto score = eval::covariance_score(gt, claims, origin);
  if (!score) {
    spdlog::warn(
        "{}: no covariance was evaluated: none is positive definite, has a ground-truth pose and is 3 s "
        "later than the first pose",
        file.path);
  }
  return score;
}

/// With one pose, a run has failed: after alignment it has no error, whatever it is.
bool has_failed(const report::EvaluatedRun& run) { return run.est.poses.size() < 2; }

/// @throws InputError if no protocol found two poses to compare
void require_matches(const Trajectory& gt, const report::EvaluatedRun& run) {
  for (const eval::Evaluation& evaluation : run.evaluations) {
    if (evaluation.pairs > 1) return;
  }
  const double interval_s = seconds_between(gt.poses.front().t, gt.poses.back().t) /
                            static_cast<double>(std::max<std::size_t>(gt.poses.size(), 2) - 1);
  throw InputError(
      run.name,
      fmt::format(
          "fewer than two of {} poses have a ground-truth pose close enough in time ({}); the ground truth "
          "has one pose per {:.3g} s: --protocol strict:se3 --max-difference {:.3g} interpolates "
          "between them; or correct the stamps with --offset",
          run.est.poses.size(), run.evaluations.front().protocol, interval_s, 1.1 * interval_s));
}

/// The file name, or the complete path if several files have the same name.
std::string display_name(const std::string& path, const std::vector<std::string>& all) {
  const auto name_of = [](const std::string& file) { return std::filesystem::path(file).filename(); };
  const auto same = std::count_if(all.begin(), all.end(),
                                  [&](const std::string& other) { return name_of(other) == name_of(path); });
  return same > 1 || name_of(path).empty() ? path : name_of(path).string();
}

/// Evaluates with compat:tum and strict:se3. Where the strict protocol rejects the data, it is omitted, as it
/// was not requested explicitly.
std::vector<eval::Evaluation> evaluate_by_default(const eval::EvaluationInput& input,
                                                  const std::string& name) {
  std::vector<eval::Evaluation> evaluations{eval::evaluate("compat:tum", input)};
  try {
    evaluations.push_back(eval::evaluate("strict:se3", input));
  } catch (const InputError& error) {
    spdlog::warn("{}: omitted: {}", name, error.what());
  }
  return evaluations;
}

/// From --level, or from the result.json beside the trajectory of a run.
std::optional<Eigen::Quaterniond> leveling_rotation(const EvalArguments& arguments, const std::string& path) {
  if (!arguments.level.empty()) {
    if (auto q_level_w = read_leveling_rotation(arguments.level)) return q_level_w;
    throw InputError(arguments.level, "has no leveling_rotation_xyzw; use the result.json of a run");
  }
  const std::filesystem::path result = std::filesystem::path(path).replace_filename("result.json");
  return std::filesystem::exists(result) ? read_leveling_rotation(result) : std::nullopt;
}

/// @param files ground truth and estimates, whose poses move to the result
std::vector<report::EvaluatedRun> evaluate_all(const EvalArguments& arguments, std::span<PoseFile> files) {
  const Trajectory& gt = files.front().loaded.trajectory;
  eval::ProtocolOptions options = protocol_options(arguments);
  std::vector<report::EvaluatedRun> runs;
  for (PoseFile& file : files.subspan(1)) {
    const std::string& path = file.path;
    report::EvaluatedRun run{.name = display_name(path, arguments.files.estimates),
                             .covariance = covariance_score_of(arguments, gt, file)};
    run.est = std::move(file.loaded.trajectory);
    run.repairs = file.loaded.repairs;
    if (has_failed(run) && arguments.files.estimates.size() == 1)
      throw InputError(path, "has one pose: a failed run, of which no error can be computed");
    const bool comparable = !arguments.find_offset && !has_failed(run);
    if (comparable) eval::require_overlap(gt, run.est, arguments.offset_s, path);
    options.q_level_w = leveling_rotation(arguments, path);
    const eval::EvaluationInput input{gt, run.est, options};
    for (const std::string& protocol : arguments.protocols)
      run.evaluations.push_back(eval::evaluate(protocol, input));
    if (arguments.protocols.empty()) run.evaluations = evaluate_by_default(input, run.name);
    if (comparable) require_matches(gt, run);
    runs.push_back(std::move(run));
  }
  return runs;
}

/// The estimate with --offset added to its stamps.
Trajectory shifted_estimate(const EvalArguments& arguments, const report::EvaluatedRun& run) {
  Trajectory shifted = run.est;
  for (StampedPose& pose : shifted.poses) pose.t = after(pose.t, arguments.offset_s);
  return shifted;
}

std::vector<std::string> warnings_about(const EvalArguments& arguments, const Trajectory& gt,
                                        const report::EvaluatedRun& run) {
  std::vector<std::string> warnings;
  const std::vector<eval::ConventionFinding> findings =
      arguments.offset_s == 0.0 ? eval::find_convention_violations(gt, run.est)
                                : eval::find_convention_violations(gt, shifted_estimate(arguments, run));
  warnings.reserve(findings.size());
  for (const eval::ConventionFinding& finding : findings) warnings.push_back(finding.message);
  return warnings;
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
  if (arguments.rpe_unit == "s") {
    setup.options.rpe_delta_s = arguments.rpe_delta;
  } else {
    setup.ignored.push_back(
        fmt::format("--rpe-delta {:g} --rpe-unit {}", arguments.rpe_delta, arguments.rpe_unit));
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

std::string_view alignment_name(eval::Alignment alignment) {
  for (const auto& [kind, name] : enum_names(alignment)) {
    if (kind == alignment) return name;
  }
  return "?";
}

std::string comparison_heading(const ComparisonSetup& setup, double common_s) {
  return fmt::format(
      "\nComparison over {:.2f} s for which all successful runs have poses (ground truth interpolated "
      "between "
      "neighbors less than {:g} s away, alignment {}, relative errors over {:g} s{}{}):\n",
      common_s, setup.options.max_gap_s, alignment_name(setup.options.alignment), setup.options.rpe_delta_s,
      setup.ignored.empty() ? "" : "; not followed: ", fmt::join(setup.ignored, ", "));
}

Json comparison_document(const EvalArguments& arguments, const Trajectory& gt,
                         const std::vector<report::EvaluatedRun>& runs) {
  const ComparisonSetup setup = comparison_setup(arguments);
  Json json = report::comparison_json(compare(arguments, gt, runs));
  json["max_difference_s"] = setup.options.max_gap_s;
  json["alignment"] = alignment_name(setup.options.alignment);
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
  json["protocols"]["rpe"] = fmt::format("{} RPE over {:g} {}.", text, first.rpe_delta, arguments.rpe_unit);
  for (const std::string_view id : {metric_id::kCorrectRate, metric_id::kCoverage, metric_id::kFirstPose}) {
    const std::string key(id);
    if (evaluation.at(key).is_null()) continue;
    json[key] = evaluation.at(key);
    json["protocols"][key] = text;
  }
  return json;
}

/// The document of a single estimate has the keys of a result.json at its top level.
Json document(const EvalArguments& arguments, const eval::LoadedTrajectory& truth,
              const std::vector<report::EvaluatedRun>& runs) {
  const Trajectory& gt = truth.trajectory;
  Json list = Json::array();
  for (const report::EvaluatedRun& run : runs) {
    Json json = top_level_metrics(arguments, gt, run);
    json["estimate"] = run.name;
    json["status"] = status_name(has_failed(run) ? Outcome::kLost : Outcome::kOk);
    json["rows"] = {{"ground_truth", rows_json(truth.repairs)}, {"estimate", rows_json(run.repairs)}};
    json["warnings"] = warnings_about(arguments, gt, run);
    for (const eval::Evaluation& evaluation : run.evaluations)
      json["evaluations"].push_back(report::evaluation_json(evaluation));
    if (run.covariance) json["covariance"] = report::covariance_json(*run.covariance);
    list.push_back(std::move(json));
  }
  Json json{{"schema", 1}};
  if (list.size() == 1) {
    json.update(list.front());
  } else {
    json["runs"] = std::move(list);
    json["comparison"] = comparison_document(arguments, gt, runs);
  }
  return json;
}

void print_tables(const EvalArguments& arguments, const Trajectory& gt,
                  const std::vector<report::EvaluatedRun>& runs) {
  const report::TableStyle style = arguments.csv        ? report::TableStyle::kCsv
                                   : arguments.markdown ? report::TableStyle::kMarkdown
                                                        : report::TableStyle::kText;
  std::cout << report::evaluation_table(runs, style);
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
    for (const eval::Evaluation& evaluation : run.evaluations) {
      for (const std::string& note : evaluation.notes) {
        spdlog::info("{}, {}: {}", run.name, evaluation.protocol, note);
      }
    }
    for (const std::string& warning : warnings_about(arguments, gt, run))
      spdlog::warn("{}: {}", run.name, warning);
  }
}

std::vector<report::PlottedRun> plotted_runs(const std::vector<report::EvaluatedRun>& runs) {
  std::vector<report::PlottedRun> plotted;
  plotted.reserve(runs.size());
  for (const report::EvaluatedRun& run : runs)
    plotted.push_back({run.name, &run.est, &run.evaluations.front()});
  return plotted;
}

/// What --plot and --per-pose must not overwrite.
OutputRules output_rules(const EvalArguments& arguments) {
  OutputRules rules{.inputs = {arguments.files.ground_truth, arguments.files.times, arguments.files.covariance},
                    .force = arguments.force,
                    .beginning = report::per_pose_header()};
  rules.inputs.insert(rules.inputs.end(), arguments.files.estimates.begin(), arguments.files.estimates.end());
  return rules;
}

void print_offsets(const Trajectory& gt, const std::vector<report::EvaluatedRun>& runs) {
  for (const report::EvaluatedRun& run : runs) {
    const std::optional<eval::TimeOffset> found = eval::find_time_offset(gt, run.est);
    if (!found) throw InputError(run.name, "too few poses to estimate a time offset");
    if (!found->undetermined.empty())
      throw InputError(run.name, "time offset not determined: " + found->undetermined);
    std::cout << fmt::format("{}: offset {:+.5f} s (ATE {:.6f} m; {:.6f} m without offset)\n", run.name,
                             found->offset_s, found->ate_rmse_m, found->ate_rmse_at_zero_m);
  }
}

int evaluate_files(const EvalArguments& arguments) {
  if (arguments.files.ground_truth.empty() || arguments.files.estimates.empty()) {
    throw InputError("command line", "eval requires a ground truth and an estimate; try --help");
  }
  const OutputRules rules = output_rules(arguments);
  if (!arguments.plot.empty()) report::require_drawing_file(arguments.plot, rules);
  if (!arguments.map.empty()) report::require_drawing_file(arguments.map, rules);
  if (!arguments.per_pose.empty()) require_safe_output(arguments.per_pose, rules);
  std::vector<PoseFile> files = with_consistent_orders(read_pose_files(arguments.files), arguments.offset_s);
  const eval::LoadedTrajectory& truth = files.front().loaded;
  const Trajectory& gt = truth.trajectory;
  const std::vector<report::EvaluatedRun> runs = evaluate_all(arguments, files);
  if (arguments.json) {
    std::cout << document(arguments, truth, runs).dump(2) << '\n';
  } else {
    print_tables(arguments, gt, runs);
  }
  if (arguments.find_offset) print_offsets(gt, runs);
  if (!arguments.plot.empty())
    report::write_drawing(arguments.plot, report::trajectory_plot(gt, plotted_runs(runs)), kPlotPixelsPerUnit,
                          rules);
  if (!arguments.map.empty())
    report::write_drawing(arguments.map, report::local_map(gt, plotted_runs(runs)), kPlotPixelsPerUnit,
                          rules);
  if (!arguments.per_pose.empty()) write_output(arguments.per_pose, report::per_pose_csv(runs), rules);
  return std::ranges::any_of(runs, has_failed) ? kExitFindings : kExitOk;
}

/// @param a receives the values when the command line is parsed
std::vector<Option> options_of(EvalArguments& a) {
  return {
      {"GT",
       "Ground-truth trajectory: a file, or BAG:/TOPIC of a bag (poses; /tf:PARENT.CHILD for a chain of "
       "transforms)",
       &a.files.ground_truth},
      {"EST", "Estimated trajectories of the same body frame", &a.files.estimates},
      {"--protocol",
       "Evaluation protocol: compat:tum, compat:evo, compat:rpg, compat:openloris, strict:se3 ...; may be "
       "repeated",
       &a.protocols,
       {},
       "--recipe"},
      {"--align", "Override the alignment of the protocol: " + enum_list<eval::Alignment>(), &a.alignment},
      {"--align-first", "Align with the first N matches only", &a.align_first, {1, 1e9}},
      {"--level", "File with leveling_rotation_xyzw, for alignment yaw [result.json beside EST]", &a.level},
      {"--rpe-delta", "RPE interval, in units of --rpe-unit", &a.rpe_delta, {1e-6, 1e6}},
      {"--rpe-unit", "Unit of the RPE interval: s, f (frames) or m", &a.rpe_unit},
      {"--offset", "Offset to add to the time stamps of the estimate [s]", &a.offset_s, {-1e9, 1e9}},
      {"--find-offset", "Estimate the time offset and print it, without applying it", &a.find_offset},
      {"--max-difference",
       "Override the maximum time difference of matched poses of the protocol [s]",
       &a.max_difference_s,
       {1e-9, 1e6}},
      {"--format",
       "Trajectory format: " + enum_list<eval::TrajectoryFormat>() +
           "; of one file: gt=FORMAT, est=FORMAT [detected]",
       &a.files.formats},
      {"--times", "File of time stamps of a KITTI trajectory", &a.files.times},
      {"--seq", "Sequence number in an OpenLORIS file", &a.files.sequence, {0, 1e9}},
      {"--covariance",
       "File with the covariances of the estimate: stamp and 6 (variances), 21 (upper triangle) or 36 "
       "numbers of "
       "position and rotation [further columns of EST, or its messages]",
       &a.files.covariance},
      {"--explain", "Print a description of each protocol", &a.explain},
      {"--json", "Print JSON with full precision", &a.json},
      {"--csv", "Print CSV", &a.csv},
      {"--markdown", "Print Markdown", &a.markdown},
      {"--map", "Write a plan with scale and north arrow; GT may be NMEA sentences of a GNSS receiver",
       &a.map},
      {"--plot", "Write a plot of trajectories and errors (.svg, .pdf or .png)", &a.plot},
      {"--per-pose", "Write the errors of all poses as CSV", &a.per_pose},
      {"--force", "Replace existing files of --plot and --per-pose", &a.force}};
}

}  // namespace

Command eval_command() {
  const auto arguments = std::make_shared<EvalArguments>();
  return {
      .name = "eval",
      .summary = "Evaluate trajectories against ground truth with named protocols",
      .example = "eval groundtruth.txt trajectory.tum --protocol compat:tum --protocol strict:se3 --explain",
      .options = options_of(*arguments),
      .action = [arguments] { return evaluate_files(*arguments); },
      .subcommands = {eval_openloris_command()}};
}

}  // namespace stillpoint::bench
