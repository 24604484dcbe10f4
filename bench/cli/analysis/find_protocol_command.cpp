// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint eval find-protocol`: which definition yields a published number.
#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/cli/analysis/pose_files.h"
#include "bench/cli/command_line.h"
#include "core/base/error.h"
#include "eval/protocols/protocol_search.h"
#include "eval/trajectory/association.h"
#include "reports/tables/data_table.h"

namespace stillpoint::bench {
namespace {

constexpr std::size_t kNearest = 5;  // shown if none agrees

struct FindProtocolArguments {
  std::string ground_truth;
  std::string estimate;
  std::string number;
  std::vector<std::string> metrics;
  std::vector<std::string> formats;
  bool json = false;
};

void keep_metrics(std::vector<eval::DefinedNumber>& found, const std::vector<std::string>& words) {
  const std::size_t all = found.size();
  std::erase_if(found, [&](const eval::DefinedNumber& defined) {
    const std::string metric = " " + defined.metric + " ";
    return !std::ranges::all_of(
        words, [&](const std::string& word) { return metric.find(" " + word + " ") != std::string::npos; });
  });
  if (all > 0 && found.empty())
    throw InputError("--metric",
                     "no metric has all of these words; expected: ATE or RPE; rmse, mean, median, "
                     "std or max; m or deg");
}

report::DataTable data_of(const std::vector<eval::DefinedNumber>& found) {
  report::DataTable table{.kind = "eval_find_protocol",
                          .columns = {"agrees", "value", "metric", "pairs", "protocol", "options"},
                          .rows = {},
                          .notes = {}};
  for (const eval::DefinedNumber& defined : found)
    table.rows.push_back({defined.agrees, defined.value, defined.metric, report::data_value(defined.pairs),
                          defined.protocol, report::data_value(defined.options)});
  return table;
}

void print_table(const std::vector<eval::DefinedNumber>& found, std::size_t agreeing,
                 const std::string& number) {
  std::cout << fmt::format("{} of {} definitions yield {}{}\n", agreeing, found.size(), number,
                           agreeing == 0 ? "; the nearest ones:" : "");
  const std::size_t shown = agreeing == 0 ? std::min(kNearest, found.size()) : agreeing;
  std::cout << fmt::format("{:>12}  {:<24} {:>7}  {}\n", "value", "metric", "pairs", "definition");
  for (std::size_t i = 0; i < shown; ++i) {
    const eval::DefinedNumber& defined = found[i];
    std::cout << fmt::format("{:>12.6g}  {:<24} {:>7}  {}{}{}\n", defined.value, defined.metric,
                             defined.pairs, defined.protocol, defined.options.empty() ? "" : " ",
                             defined.options);
  }
  if (agreeing > 1)
    std::cout << "Several definitions yield it: some by chance. A second number of the same source, or more "
                 "digits, tells them apart.\n";
  if (agreeing == 0)
    std::cout << "The number may be of another run, another ground truth, another unit or an average.\n";
}

int find_protocol(const FindProtocolArguments& arguments) {
  const eval::PublishedNumber number = eval::parse_published(arguments.number);
  const std::vector<PoseFile> files =
      with_consistent_orders(read_pose_files({.ground_truth = arguments.ground_truth,
                                              .estimates = {arguments.estimate},
                                              .formats = arguments.formats}),
                             0.0);
  const Trajectory& gt = files[0].loaded.trajectory;
  const Trajectory& est = files[1].loaded.trajectory;
  if (est.poses.size() < 2)
    throw InputError(arguments.estimate, "has fewer than two poses, of which no error can be computed");
  eval::require_overlap(gt, est, 0.0, arguments.estimate);
  std::vector<eval::DefinedNumber> found = eval::search_protocols(gt, est, number);
  if (found.empty())
    throw InputError(arguments.estimate, "no definition can be applied: too few poses have a ground truth");
  keep_metrics(found, arguments.metrics);
  const auto agreeing = static_cast<std::size_t>(std::ranges::count_if(found, &eval::DefinedNumber::agrees));
  if (arguments.json) {
    std::cout << report::data_json(data_of(found));
  } else {
    print_table(found, agreeing, arguments.number);
  }
  return agreeing > 0 ? kExitOk : kExitFindings;
}

}  // namespace

Command find_protocol_command() {
  const auto arguments = std::make_shared<FindProtocolArguments>();
  return {
      .name = "find-protocol",
      .summary =
          "Find which alignment, association, interval and statistic yield a published number; exit code 1 "
          "= none",
      .example = "eval find-protocol groundtruth.txt trajectory.tum 0.0153 --metric ATE",
      .options = {{"GT", "Ground truth, as for eval", &arguments->ground_truth},
                  {"EST", "The trajectory of which the number was published", &arguments->estimate},
                  {"NUMBER", "The number with all printed digits, in m or deg: 0.0150 is not 0.015",
                   &arguments->number},
                  {"--metric",
                   "Only metrics with this word: ATE, RPE, rmse, mean, median, std, max, m, deg; may be "
                   "repeated",
                   &arguments->metrics},
                  {"--format", "Trajectory format; of one file: gt=FORMAT, est=FORMAT [detected]",
                   &arguments->formats},
                  {"--json", "Print all definitions as JSON", &arguments->json}},
      .action = [arguments] { return find_protocol(*arguments); }};
}

}  // namespace stillpoint::bench
