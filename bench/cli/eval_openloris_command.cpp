// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iostream>
#include <memory>

#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"
#include "eval/openloris/benchmark.h"
#include "reports/evaluation_json.h"
#include "reports/openloris_figure.h"
#include "reports/openloris_table.h"
#include "reports/raster_drawing.h"
#include "reports/svg_drawing.h"

namespace stillpoint {
namespace {

struct OpenlorisArguments {
  std::string results;
  std::string ground_truth;
  std::string figure;
  bool lifelong = false;
  bool keep_repeated = false;
  bool json = false;
  bool csv = false;
  bool markdown = false;
};

void write_figure(const std::string& base, const OpenlorisBenchmark& benchmark) {
  const Drawing drawing = openloris_figure(benchmark);
  write_text_file(base + ".svg", svg_text(drawing));
  write_drawing_png(base + ".png", drawing, 1.0);
}

int evaluate_folder(const OpenlorisArguments& arguments) {
  if (arguments.ground_truth.empty()) {
    throw InputError("--ground-truth", "is missing; name the folder with gt_<scene>_1.txt");
  }
  const OpenlorisEvaluation evaluation = evaluate_openloris(arguments.results, arguments.ground_truth,
                                                            {.metric = {},
                                                             .lifelong_thresholds = arguments.lifelong,
                                                             .keep_repeated_poses = arguments.keep_repeated});
  for (const std::string& sentence : evaluation.skipped) spdlog::warn("{}", sentence);
  if (arguments.json) {
    std::cout << openloris_json(evaluation).dump(2) << '\n';
  } else {
    const TableStyle style = arguments.csv        ? TableStyle::kCsv
                             : arguments.markdown ? TableStyle::kMarkdown
                                                  : TableStyle::kText;
    std::cout << openloris_table(evaluation.benchmark, style);
  }
  if (!arguments.figure.empty()) write_figure(arguments.figure, evaluation.benchmark);
  return kExitOk;
}

}  // namespace

Command eval_openloris_command() {
  const auto arguments = std::make_shared<OpenlorisArguments>();
  OpenlorisArguments& a = *arguments;
  return {.name = "openloris",
          .summary = "Score a folder of OpenLORIS result files, a folder a system, by scene",
          .example = "eval openloris results --ground-truth groundtruth --figure openloris",
          .options = {{"RESULTS", "Folder with a folder for each system", &a.results},
                      {"--ground-truth", "Folder with gt_<scene>_1.txt", &a.ground_truth},
                      {"--figure", "Write the paper's figure as BASE.svg and BASE.png", &a.figure},
                      {"--lifelong", "Correct within 1, 3 or 5 m by scene and 30 deg (default: any pose)",
                       &a.lifelong},
                      {"--keep-repeated", "Keep poses equal to the one before", &a.keep_repeated},
                      {"--json", "Print JSON in full precision", &a.json},
                      {"--csv", "Print CSV", &a.csv},
                      {"--markdown", "Print Markdown", &a.markdown}},
          .action = [arguments] { return evaluate_folder(*arguments); },
          .subcommands = {}};
}

}  // namespace stillpoint
