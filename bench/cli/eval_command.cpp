// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/record/score_text.h"
#include "core/base/error.h"
#include "eval/compare/conventions.h"
#include "eval/io/any_trajectory.h"
#include "eval/io/text_reader.h"
#include "eval/trajectory/time_offset.h"
#include "reports/evaluation_json.h"
#include "reports/evaluation_table.h"
#include "reports/raster_drawing.h"
#include "reports/svg_drawing.h"
#include "reports/trajectory_plot.h"

namespace stillpoint {
namespace {

using Json = nlohmann::ordered_json;

struct EvalArguments {
  std::string ground_truth;
  std::vector<std::string> estimates;
  std::vector<std::string> recipes;
  std::string alignment;
  int align_first = 0;
  double rpe_delta = 1.0;
  std::string rpe_unit = "s";
  double offset_s = 0.0;
  double max_difference_s = 0.0;
  std::string format;
  std::string times;
  int sequence = 0;
  bool find_offset = false;
  bool explain = false;
  bool json = false;
  bool csv = false;
  bool markdown = false;
  std::string plot;
  std::string per_pose;
};

template <class Enum>
Enum enum_of(const std::string& option, const std::string& value) {
  std::string known;
  for (const auto& [candidate, name] : enum_names(Enum{})) {
    if (name == value) return candidate;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  throw InputError(option + " " + value, "is not known; there are " + known);
}

RecipeOptions recipe_options(const EvalArguments& arguments) {
  if (!(arguments.rpe_delta > 0.0)) throw InputError("--rpe-delta", "must be above 0");
  RecipeOptions options;
  if (!arguments.alignment.empty()) options.alignment = enum_of<Alignment>("--align", arguments.alignment);
  options.align_first_n = static_cast<std::size_t>(std::max(arguments.align_first, 0));
  if (arguments.max_difference_s > 0.0) options.max_difference_s = arguments.max_difference_s;
  options.rpe_delta = arguments.rpe_delta;
  options.rpe_unit = enum_of<RpeUnit>("--rpe-unit", arguments.rpe_unit);
  options.offset_s = arguments.offset_s;
  return options;
}

Trajectory load(const EvalArguments& arguments, const std::string& path) {
  LoadedTrajectory loaded = read_trajectory(
      {.path = path, .format = arguments.format, .times = arguments.times, .sequence = arguments.sequence});
  if (loaded.skipped_rows > 0)
    spdlog::warn("{}: {} rows are no pose and were skipped", path, loaded.skipped_rows);
  return std::move(loaded.trajectory);
}

/// The file's name, or the whole path where two files have one name.
std::string shown_name(const std::string& path, const std::vector<std::string>& all) {
  const auto name_of = [](const std::string& file) { return std::filesystem::path(file).filename(); };
  const auto same = std::count_if(all.begin(), all.end(),
                                  [&](const std::string& other) { return name_of(other) == name_of(path); });
  return same > 1 || name_of(path).empty() ? path : name_of(path).string();
}

/// Without a choice the TUM tools' numbers and ours; ours may need more than the path gives (it is a line, it
/// stands still), which is an error only where it was asked for.
std::vector<Evaluation> evaluate_by_default(const EvaluationInput& input, const std::string& name) {
  std::vector<Evaluation> evaluations{evaluate("compat:tum", input)};
  try {
    evaluations.push_back(evaluate("strict:se3", input));
  } catch (const InputError& error) {
    spdlog::warn("{}: left out: {}", name, error.what());
  }
  return evaluations;
}

std::vector<EvaluatedRun> evaluate_all(const EvalArguments& arguments, const Trajectory& gt) {
  const RecipeOptions options = recipe_options(arguments);
  std::vector<EvaluatedRun> runs;
  for (const std::string& path : arguments.estimates) {
    EvaluatedRun run{
        .name = shown_name(path, arguments.estimates), .est = load(arguments, path), .evaluations = {}};
    const EvaluationInput input{gt, run.est, options};
    for (const std::string& recipe : arguments.recipes) run.evaluations.push_back(evaluate(recipe, input));
    if (arguments.recipes.empty()) run.evaluations = evaluate_by_default(input, run.name);
    runs.push_back(std::move(run));
  }
  return runs;
}

std::vector<std::string> warnings_about(const Trajectory& gt, const EvaluatedRun& run) {
  std::vector<std::string> warnings;
  for (const ConventionFinding& finding : find_convention_mistakes(gt, run.est))
    warnings.push_back(finding.sentence);
  return warnings;
}

Comparison compare(const Trajectory& gt, const std::vector<EvaluatedRun>& runs) {
  std::vector<NamedRun> named;
  for (const EvaluatedRun& run : runs) named.push_back({run.name, run.est});
  return compare_runs(gt, named);
}

/// One estimate: the members of a run's result.json at the top, so that both are read alike.
Json document(const EvalArguments& arguments, const Trajectory& gt, const std::vector<EvaluatedRun>& runs) {
  Json list = Json::array();
  for (const EvaluatedRun& run : runs) {
    const ScoreOptions options{.offset_s = arguments.offset_s, .expected_times = {}};
    Json json = score_members(score(gt, run.est, options));
    json["estimate"] = run.name;
    json["warnings"] = warnings_about(gt, run);
    for (const Evaluation& evaluation : run.evaluations)
      json["evaluations"].push_back(evaluation_json(evaluation));
    list.push_back(std::move(json));
  }
  if (list.size() == 1) return list.front();
  return {{"runs", list}, {"comparison", comparison_json(compare(gt, runs))}};
}

void print_tables(const EvalArguments& arguments, const Trajectory& gt,
                  const std::vector<EvaluatedRun>& runs) {
  const TableStyle style = arguments.csv        ? TableStyle::kCsv
                           : arguments.markdown ? TableStyle::kMarkdown
                                                : TableStyle::kText;
  std::cout << evaluation_table(runs, style);
  if (runs.size() > 1 && style != TableStyle::kCsv) {
    const Comparison comparison = compare(gt, runs);
    std::cout << fmt::format(
                     "\nCompared over the {:.2f} s in which all runs that did not fail have a pose:\n",
                     comparison.common_s)
              << comparison_table(comparison, style);
  }
  if (arguments.explain) std::cout << '\n' << explanation_text(runs);
  for (const EvaluatedRun& run : runs) {
    for (const Evaluation& evaluation : run.evaluations) {
      for (const std::string& note : evaluation.notes) {
        spdlog::info("{}, {}: {}", run.name, evaluation.recipe, note);
      }
    }
    for (const std::string& warning : warnings_about(gt, run)) spdlog::warn("{}: {}", run.name, warning);
  }
}

void write_plot(const std::filesystem::path& file, const Trajectory& gt,
                const std::vector<EvaluatedRun>& runs) {
  std::vector<PlottedRun> plotted;
  for (const EvaluatedRun& run : runs) plotted.push_back({run.name, &run.est, &run.evaluations.front()});
  const Drawing drawing = trajectory_plot(gt, plotted);
  if (file.extension() == ".png") {
    write_drawing_png(file, drawing, 1.5);
  } else {
    write_text_file(file, svg_text(drawing));
  }
}

void print_offsets(const Trajectory& gt, const std::vector<EvaluatedRun>& runs) {
  for (const EvaluatedRun& run : runs) {
    const std::optional<TimeOffset> found = find_time_offset(gt, run.est);
    if (!found) throw InputError(run.name, "too few poses match to search for a time offset");
    std::cout << fmt::format("{}: offset {:+.5f} s (ATE {:.6f} m, without it {:.6f} m)\n", run.name,
                             found->offset_s, found->ate_rmse_m, found->ate_rmse_at_zero_m);
  }
}

int evaluate_files(const EvalArguments& arguments) {
  if (arguments.ground_truth.empty() || arguments.estimates.empty()) {
    throw InputError("command line", "eval needs a ground truth and an estimate; try --help");
  }
  const Trajectory gt = load(arguments, arguments.ground_truth);
  const std::vector<EvaluatedRun> runs = evaluate_all(arguments, gt);
  if (arguments.json) {
    std::cout << document(arguments, gt, runs).dump(2) << '\n';
  } else {
    print_tables(arguments, gt, runs);
  }
  if (arguments.find_offset) print_offsets(gt, runs);
  if (!arguments.plot.empty()) write_plot(arguments.plot, gt, runs);
  if (!arguments.per_pose.empty()) write_text_file(arguments.per_pose, per_pose_csv(runs));
  return kExitOk;
}

std::vector<Option> options_of(EvalArguments& a) {
  return {
      {"GT", "Ground truth", &a.ground_truth},
      {"EST", "Estimates, of the same frame of the robot", &a.estimates},
      {"--recipe", "compat:tum, compat:evo, compat:rpg, compat:openloris, strict:se3 ...; may be repeated",
       &a.recipes},
      {"--align", "none, first_pose, yaw, se3 or sim3 instead of the recipe's", &a.alignment},
      {"--align-first", "Align over the first N matches only", &a.align_first},
      {"--rpe-delta", "Span of the RPE", &a.rpe_delta},
      {"--rpe-unit", "s, f (frames) or m", &a.rpe_unit},
      {"--offset", "Seconds to add to the estimate's stamps", &a.offset_s},
      {"--find-offset", "Search for that offset and print it; nothing is applied", &a.find_offset},
      {"--max-difference", "Greatest difference of paired stamps [s] instead of the recipe's",
       &a.max_difference_s},
      {"--format", "tum, euroc, kitti, openloris or 7scenes; recognised when not given", &a.format},
      {"--times", "KITTI's file of times", &a.times},
      {"--seq", "Sequence of an OpenLORIS file", &a.sequence},
      {"--explain", "Print what each recipe does", &a.explain},
      {"--json", "Print JSON in full precision", &a.json},
      {"--csv", "Print CSV", &a.csv},
      {"--markdown", "Print Markdown", &a.markdown},
      {"--plot", "Write paths and errors as .svg or .png", &a.plot},
      {"--per-pose", "Write the error of every pose as CSV", &a.per_pose}};
}

}  // namespace

Command eval_command() {
  const auto arguments = std::make_shared<EvalArguments>();
  return {.name = "eval",
          .summary = "Score trajectories against ground truth, by named recipes",
          .example = "eval groundtruth.txt trajectory.tum --recipe compat:tum --recipe strict:se3 --explain",
          .options = options_of(*arguments),
          .action = [arguments] { return evaluate_files(*arguments); },
          .subcommands = {eval_openloris_command()}};
}

}  // namespace stillpoint
