// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint eval`: evaluates trajectory files.
#include <algorithm>
#include <filesystem>
#include <future>
#include <iostream>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "bench/cli/analysis/eval_results.h"
#include "bench/cli/command_line.h"
#include "bench/record/result_values.h"
#include "core/base/error.h"
#include "eval/compare/conventions.h"
#include "eval/compare/hand_eye.h"
#include "eval/compare/time_offset.h"
#include "eval/protocols/protocol.h"
#include "eval/trajectory/alignment.h"
#include "eval/trajectory/association.h"
#include "reports/drawing/evaluation/figures.h"

namespace stillpoint::bench {
namespace {

/// A tenth of the poses without a covariance is more than a first pose that is known exactly.
void warn_of_missing(const std::vector<eval::StampedCovariance>& rows, const std::string& file) {
  const auto missing = static_cast<std::size_t>(std::ranges::count_if(
      rows, [](const eval::StampedCovariance& row) { return row.position.isZero(0.0); }));
  if (10 * missing > rows.size())
    spdlog::warn("{}: {} of {} poses have no covariance less than 1 ms from their stamp", file, missing,
                 rows.size());
}

/// The poses with their covariances; nullopt without any.
std::optional<eval::CovarianceScore> covariance_score_of(const EvalArguments& arguments, const Trajectory& gt,
                                                         const PoseFile& file) {
  if (!file.covariances) return std::nullopt;
  if (arguments.alignment == kHandEyeAlignment) {
    spdlog::warn(
        "{}: covariances are of the body frame before the hand-eye calibration and were not evaluated",
        file.path);
    return std::nullopt;
  }
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
  } else {
    warn_of_missing(rows, file.path);
  }
  return score;
}

/// Mean interval of the poses [s].
double interval_of(const Trajectory& path) {
  return seconds_between(path.poses.front().t, path.poses.back().t) /
         static_cast<double>(std::max<std::size_t>(path.poses.size(), 2) - 1);
}

/// @throws InputError if no protocol found two poses to compare
void require_matches(const Trajectory& gt, const report::EvaluatedRun& run) {
  for (const eval::Evaluation& evaluation : run.evaluations) {
    if (evaluation.pairs > 1) return;
  }
  constexpr double kSlow = 5.0;  // [s]
  const double interval_s = interval_of(gt);
  if (std::min(interval_s, interval_of(run.est)) >= kSlow) {
    throw InputError(
        run.name,
        fmt::format("fewer than two of {} poses have a ground-truth pose close enough in time ({}); "
                    "the ground truth has one pose per {:.3g} s: if the stamps are in milliseconds or "
                    "finer, convert them to seconds",
                    run.est.poses.size(), run.evaluations.front().protocol, interval_s));
  }
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

/// Evaluates with a protocol and each interval of relative errors. Those after the first only have the notes
/// that the first one does not have.
std::vector<eval::Evaluation> evaluate_over_deltas(const std::string& protocol,
                                                   const eval::EvaluationInput& input,
                                                   const std::vector<RpeDelta>& deltas) {
  std::vector<eval::Evaluation> evaluations;
  for (const RpeDelta& delta : deltas) {
    eval::ProtocolOptions options = input.options;
    options.rpe_delta = delta.value;
    options.rpe_unit = delta.unit;
    options.per_pose = options.per_pose && evaluations.empty();
    eval::Evaluation evaluation = eval::evaluate(protocol, {input.gt, input.est, options});
    if (!evaluations.empty()) {
      const std::vector<std::string>& known = evaluations.front().notes;
      std::erase_if(evaluation.notes,
                    [&](const std::string& note) { return std::ranges::find(known, note) != known.end(); });
    }
    evaluations.push_back(std::move(evaluation));
  }
  return evaluations;
}

/// Evaluates with compat:tum and strict:se3. Where the strict protocol rejects the data, it is omitted, as it
/// was not requested explicitly.
std::vector<eval::Evaluation> evaluate_by_default(const eval::EvaluationInput& input, const std::string& name,
                                                  const std::vector<RpeDelta>& deltas) {
  std::vector<eval::Evaluation> evaluations = evaluate_over_deltas("compat:tum", input, deltas);
  try {
    for (eval::Evaluation& evaluation : evaluate_over_deltas("strict:se3", input, deltas))
      evaluations.push_back(std::move(evaluation));
  } catch (const InputError& error) {
    spdlog::warn("{}: omitted: {}", name, error.what());
  }
  return evaluations;
}

/// Conventions that the estimate seems to violate, with --offset added to its stamps.
std::vector<std::string> warnings_about(const EvalArguments& arguments, const Trajectory& gt,
                                        const report::EvaluatedRun& run) {
  std::vector<std::string> warnings;
  for (eval::ConventionFinding& finding :
       arguments.offset_s == 0.0 ? eval::find_convention_violations(gt, run.est)
                                 : eval::find_convention_violations(gt, shifted_estimate(arguments, run)))
    warnings.push_back(std::move(finding.message));
  return warnings;
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

/// The estimate with the body frame and clock of the ground truth.
/// @throws InputError if the motion does not determine them
report::EvaluatedRun hand_eye_calibrated(const EvalArguments& arguments, const Trajectory& gt,
                                         report::EvaluatedRun run) {
  if (arguments.offset_s != 0.0) throw InputError("--align hand-eye", "solves for the offset; omit --offset");
  const eval::HandEye found = eval::hand_eye(gt, run.est);
  if (!found.undetermined.empty()) throw InputError(run.name, "hand-eye calibration: " + found.undetermined);
  run.est = eval::move_to_frame(run.est, found.T_f_g, gt.frame);
  for (StampedPose& pose : run.est.poses) pose.t = after(pose.t, found.offset_s);
  run.hand_eye = found;
  return run;
}

/// @param files ground truth and estimates, whose poses move to the result
std::vector<report::EvaluatedRun> evaluate_all(const EvalArguments& arguments, std::span<PoseFile> files) {
  const Trajectory& gt = files.front().loaded.trajectory;
  eval::ProtocolOptions options = protocol_options(arguments);
  const std::vector<RpeDelta> deltas = rpe_deltas(arguments);
  std::vector<report::EvaluatedRun> runs;
  for (PoseFile& file : files.subspan(1)) {
    const std::string& path = file.path;
    const std::string& given = arguments.files.estimates[runs.size()];  // may be the folder of a run
    report::EvaluatedRun run{.name = arguments.labels.empty() ? display_name(given, arguments.files.estimates)
                                                              : arguments.labels[runs.size()],
                             .covariance = covariance_score_of(arguments, gt, file)};
    run.est = std::move(file.loaded.trajectory);
    run.repairs = file.loaded.repairs;
    if (has_failed(run) && arguments.files.estimates.size() == 1)
      throw InputError(path, "has one pose: a failed run, of which no error can be computed");
    if (arguments.alignment == kHandEyeAlignment && !has_failed(run))
      run = hand_eye_calibrated(arguments, gt, std::move(run));
    const bool comparable = !arguments.find_offset && !has_failed(run);
    if (comparable) eval::require_overlap(gt, run.est, arguments.offset_s, path);
    options.q_level_w = leveling_rotation(arguments, path);
    const eval::EvaluationInput input{gt, run.est, options};
    std::future<std::vector<std::string>> warnings =
        std::async(std::launch::async, [&] { return warnings_about(arguments, gt, run); });
    for (const std::string& protocol : arguments.protocols) {
      for (eval::Evaluation& evaluation : evaluate_over_deltas(protocol, input, deltas))
        run.evaluations.push_back(std::move(evaluation));
    }
    if (arguments.protocols.empty()) run.evaluations = evaluate_by_default(input, run.name, deltas);
    if (comparable) require_matches(gt, run);
    run.warnings = warnings.get();
    runs.push_back(std::move(run));
  }
  return runs;
}

/// What --plot and --per-pose must not overwrite.
OutputRules output_rules(const EvalArguments& arguments) {
  OutputRules rules{.inputs = {arguments.files.ground_truth, arguments.files.times,
                               arguments.files.covariance, arguments.occupancy_grid},
                    .force = arguments.force,
                    .beginning = report::per_pose_header()};
  rules.inputs.insert(rules.inputs.end(), arguments.files.estimates.begin(), arguments.files.estimates.end());
  return rules;
}

/// @throws InputError if two outputs are the same file: the later one would replace the earlier one
void require_different_outputs(const EvalArguments& arguments) {
  std::map<std::filesystem::path, const char*> known;
  for (const auto& [option, file] : {std::pair("--plot", &arguments.plot),
                                     {"--map", &arguments.map},
                                     {"--per-pose", &arguments.per_pose}}) {
    if (file->empty()) continue;
    std::error_code ignored;
    const auto absolute = std::filesystem::absolute(*file);  // of files that do not exist, too
    const auto path = std::filesystem::weakly_canonical(absolute, ignored);
    const auto [earlier, is_new] = known.emplace(ignored ? absolute : path, option);
    if (!is_new)
      throw InputError(option,
                       fmt::format("{} is the file of {}, too; choose another one", *file, earlier->second));
  }
}

/// @throws InputError if it is not determined
eval::TimeOffset time_offset_of(const Trajectory& gt, const report::EvaluatedRun& run) {
  const std::optional<eval::TimeOffset> found = eval::find_time_offset(gt, run.est);
  if (!found) throw InputError(run.name, "too few poses to estimate a time offset");
  if (!found->undetermined.empty())
    throw InputError(run.name, "time offset not determined: " + found->undetermined);
  return *found;
}

int evaluate_files(const EvalArguments& arguments) {
  if (arguments.files.ground_truth.empty() || arguments.files.estimates.empty()) {
    throw InputError("command line", "eval requires a ground truth and an estimate; try --help");
  }
  const OutputRules rules = output_rules(arguments);
  static_cast<void>(protocol_options(arguments));  // refuses options before the files are read
  require_different_outputs(arguments);
  require_figures(arguments, rules);
  if (!arguments.per_pose.empty()) require_safe_output(arguments.per_pose, rules);
  std::vector<PoseFile> files = with_consistent_orders(read_pose_files(arguments.files), arguments.offset_s);
  const eval::LoadedTrajectory& truth = files.front().loaded;
  const Trajectory& gt = truth.trajectory;
  std::vector<report::EvaluatedRun> runs = evaluate_all(arguments, files);
  if (arguments.find_offset) {
    for (report::EvaluatedRun& run : runs) run.time_offset = time_offset_of(gt, run);
  }
  if (arguments.json) {
    std::cout << evaluation_document(arguments, truth, runs).dump(2) << '\n';
  } else {
    print_evaluations(arguments, gt, runs);
  }
  write_figures(arguments, gt, runs, rules);
  if (!arguments.per_pose.empty()) write_output(arguments.per_pose, report::per_pose_csv(runs), rules);
  return std::ranges::any_of(runs, has_failed) ? kExitFindings : kExitOk;
}

/// @param a receives the values when the command line is parsed
std::vector<Option> figure_options(EvalArguments& a) {
  return {
      {"--map", "Write a plan with scale and north arrow; GT may be NMEA sentences of a GNSS receiver",
       &a.map},
      {"--plot", "Write figures of trajectories and errors (.pdf, .svg, .png or .html)", &a.plot},
      {"--figure",
       "Figure of --plot: " + enum_list<report::FigureKind>() + " or all; may be repeated [path, error]",
       &a.figures},
      {"--plot-mode", "Axes of the path figure: " + enum_list<report::PlotMode>() + " [plan and side view]",
       &a.plot_mode},
      {"--path-mark", "Mark in the path figure: axes (of poses) or correspondences; may be repeated",
       &a.path_marks},
      {"--path-color",
       "Error that colors the path of a single estimate: " + enum_list<report::PathColor>() + " [position]",
       &a.path_color},
      {"--colormap-min", "Lower limit of the color bar [m or deg]", &a.colormap_min, {0, 1e9}},
      {"--colormap-max",
       "Upper limit of the color bar [m or deg] [the largest error]",
       &a.colormap_max,
       {1e-9, 1e9}},
      {"--colormap-percentile",
       "Upper limit of the color bar as a percentile of the errors",
       &a.colormap_percentile,
       {1e-9, 100}},
      {"--occupancy-grid", "Map below the paths in x and y: YAML file of map_server, in the world of GT",
       &a.occupancy_grid},
      {"--map-tiles",
       "Map tiles below the paths in x and y: an address with {z}, {x} and {y} (https:// or file:///); those "
       "of a server are kept in the cache folder",
       &a.map_tiles},
      {"--map-crs",
       "Coordinate reference system of GT (x east, y north) for --map-tiles: \"EPSG:32632\", or "
       "\"+proj=aeqd +lat_0=48 +lon_0=11 +datum=WGS84\" of a local plane",
       &a.map_crs},
      {"--map-credit", "Attribution that the provider of --map-tiles requires", &a.map_credit},
      {"--error-axis",
       "What the figures error, relative and transform are over: " + enum_list<report::ErrorAxis>() +
           " [time; error: distance, too]",
       &a.error_axis},
      {"--label",
       "Name of an estimate in tables and figures, in the order of EST; may be repeated [its file]",
       &a.labels},
      {"--width", "Width of figures: column (85 mm), page (180 mm), or a length such as 120mm", &a.width},
      {"--font-size", "Size of the font in figures [pt]", &a.font_size_pt, {4, 24}}};
}

/// @param a as for `figure_options`
std::vector<Option> options_of(EvalArguments& a) {
  std::vector<Option> options{
      {"GT",
       "Ground truth: a file, a sequence folder or preset, or BAG:/TOPIC of a bag (poses; /tf:PARENT.CHILD "
       "for a chain of transforms)",
       &a.files.ground_truth},
      {"EST", "Estimated trajectories of the same body frame: files, or folders of runs", &a.files.estimates},
      {"--protocol",
       "Evaluation protocol: compat:tum, compat:evo, compat:rpg, compat:openloris, strict:se3 ...; may be "
       "repeated",
       &a.protocols,
       {},
       "--recipe"},
      {"--align",
       "Override the alignment of the protocol: " + enum_list<eval::Alignment>() +
           ", posyaw (yaw), origin (first_pose), hand-eye (body frame and time offset are solved, then se3)",
       &a.alignment},
      {"--align-first", "Align with the first N matches only", &a.align_first, {1, 1e9}},
      {"--level", "File with leveling_rotation_xyzw, for alignment yaw [result.json beside EST]", &a.level},
      {"--rpe-delta", "RPE interval: 1 (in --rpe-unit), 1s, 10f, 5m, 30deg; may be repeated [1]",
       &a.rpe_deltas},
      {"--rpe-unit", "Unit of RPE intervals without one: s, f (frames), m or deg", &a.rpe_unit},
      {"--statistics", "Print mean, standard deviation, median, percentiles and maximum of the errors",
       &a.statistics},
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
      {"--per-pose", "Write the errors of all poses as CSV", &a.per_pose},
      {"--force", "Replace existing files of --plot and --per-pose", &a.force}};
  for (Option& option : figure_options(a)) options.push_back(std::move(option));
  return options;
}

}  // namespace

Command eval_command() {
  const auto arguments = std::make_shared<EvalArguments>();
  return {
      .name = "eval",
      .summary = "Evaluate trajectories against ground truth with named protocols",
      .example =
          "eval groundtruth.txt trajectory.tum --protocol compat:tum --protocol strict:se3 --explain\n"
          "  stillpoint eval groundtruth.txt trajectory.tum --plot path.pdf --figure path --plot-mode xyz",
      .options = options_of(*arguments),
      .action = [arguments] { return evaluate_files(*arguments); },
      .subcommands = {eval_openloris_command(), eval_cloud_command(), find_protocol_command()}};
}

}  // namespace stillpoint::bench
