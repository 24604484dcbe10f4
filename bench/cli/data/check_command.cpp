// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <optional>

#include "bench/cli/commands.h"
#include "bench/cli/progress.h"
#include "datasets/sequence_validator.h"

namespace stillpoint::bench {
namespace {

struct CheckArguments {
  std::string folder;
  std::string format;
  std::string rig_file;
  std::vector<std::string> topics;
};

int check(const CheckArguments& arguments) {
  std::optional<ProgressLine> line;
  const datasets::CheckOptions options{
      .open = {.format = arguments.format, .rig_file = arguments.rig_file, .topics = arguments.topics},
      .progress = [&line](std::size_t done, std::size_t total) {
        if (!line) line.emplace("decoding", total, "frames");
        line->update(done);
      }};
  const datasets::CheckReport report = datasets::check_sequence(arguments.folder, options);
  line.reset();
  std::cout << datasets::report_text(report);
  return report.exit_code();
}

}  // namespace

Command check_command() {
  const auto arguments = std::make_shared<CheckArguments>();
  return {
      .name = "check",
      .summary =
          "Validate a sequence folder or bag: contents and defects; exit code 0 = no defects, 1 = defects, 2 "
          "= "
          "unreadable",
      .example = "data check my_sequence",
      .options = {{"DIR", "Sequence folder or bag", &arguments->folder},
                  {"--format", "Sequence format: " + datasets::sequence_format_names() + " [detected]",
                   &arguments->format},
                  {"--topics", kTopicsHelp, &arguments->topics},
                  {"--rig", "rig.toml that overrides the calibration of the sequence", &arguments->rig_file}},
      .action = [arguments] { return check(*arguments); }};
}

}  // namespace stillpoint::bench
