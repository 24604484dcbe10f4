// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint eval openloris`: evaluates result files of the OpenLORIS-Scene benchmark by scene.
#include <array>
#include <iostream>
#include <memory>
#include <string>

#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "bench/cli/command_line.h"
#include "bench/record/output_folder.h"
#include "core/base/error.h"
#include "eval/openloris/benchmark.h"
#include "reports/drawing/drawing.h"
#include "reports/drawing/openloris_figure.h"
#include "reports/text/evaluation_report.h"

namespace stillpoint::bench {
namespace {

constexpr const char* kFigureExtensions[] = {".svg", ".png"};

struct OpenlorisArguments {
  std::string results;
  std::string ground_truth;
  std::string figure;
  bool lifelong = false;
  bool keep_repeated = false;
  bool json = false;
  bool csv = false;
  bool markdown = false;
  bool force = false;
};

void write_figure(const OpenlorisArguments& arguments, const eval::OpenlorisBenchmark& benchmark) {
  const std::array drawing{report::openloris_figure(benchmark)};
  for (const char* extension : kFigureExtensions)
    report::write_drawings(arguments.figure + extension, drawing, 1.0, {.force = arguments.force});
}

int evaluate_folder(const OpenlorisArguments& arguments) {
  if (arguments.ground_truth.empty()) {
    throw InputError("--ground-truth", "is required: the folder with gt_<scene>_1.txt");
  }
  for (const char* extension : kFigureExtensions) {
    if (!arguments.figure.empty())
      report::require_drawing_file(arguments.figure + extension, {.force = arguments.force});
  }
  const eval::OpenlorisEvaluation evaluation =
      eval::evaluate_openloris(arguments.results, arguments.ground_truth,
                               {.metric = {},
                                .lifelong_thresholds = arguments.lifelong,
                                .keep_repeated_poses = arguments.keep_repeated});
  for (const std::string& sentence : evaluation.skipped) spdlog::warn("{}", sentence);
  if (arguments.json) {
    std::cout << report::openloris_json(evaluation).dump(2) << '\n';
  } else {
    const report::TableStyle style = arguments.csv        ? report::TableStyle::kCsv
                                     : arguments.markdown ? report::TableStyle::kMarkdown
                                                          : report::TableStyle::kText;
    std::cout << report::openloris_table(evaluation.benchmark, style);
  }
  if (!arguments.figure.empty()) write_figure(arguments, evaluation.benchmark);
  return kExitOk;
}

}  // namespace

Command eval_openloris_command() {
  const auto arguments = std::make_shared<OpenlorisArguments>();
  OpenlorisArguments& a = *arguments;
  return {
      .name = "openloris",
      .summary = "Evaluate OpenLORIS result files by scene; one folder per system",
      .example = "eval openloris results --ground-truth groundtruth --figure openloris",
      .options = {{"RESULTS", "Folder with one folder per system", &a.results},
                  {"--ground-truth", "Folder with gt_<scene>_1.txt", &a.ground_truth},
                  {"--figure", "Write the figure of the paper as BASE.svg and BASE.png", &a.figure},
                  {"--force", "Replace existing files of --figure", &a.force},
                  {"--lifelong",
                   "Count poses as correct within 1, 3 or 5 m (by scene) and 30 deg [any pose is correct]",
                   &a.lifelong},
                  {"--keep-repeated", "Keep poses that are equal to their predecessor", &a.keep_repeated},
                  {"--json", "Print JSON with full precision", &a.json},
                  {"--csv", "Print CSV", &a.csv},
                  {"--markdown", "Print Markdown", &a.markdown}},
      .action = [arguments] { return evaluate_folder(*arguments); }};
}

}  // namespace stillpoint::bench
