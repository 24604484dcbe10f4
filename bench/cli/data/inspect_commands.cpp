// SPDX-License-Identifier: BSD-3-Clause
// `data check` and `data faults`, which the minimal build has as well.
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "datasets/faults/sensor_fault.h"
#include "datasets/open_sequence.h"
#include "datasets/sequence_validator.h"
#include "reports/tables/data_table.h"
#include "reports/tables/text_format.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;

struct CheckArguments {
  std::string folder;
  std::string format;
  std::string rig_file;
  std::vector<std::string> topics;
  bool json = false;
};

/// The schema is data_check.
std::string report_json(const datasets::CheckReport& report) {
  Json json = {{"schema", 1},
               {"sequence", report::clean_line(report.name)},
               {"format", report.format},
               {"streams", Json::array()},
               {"depth_offset_s", report.depth_offset_s},
               {"notes", Json::array()},
               {"findings", Json::array()}};
  for (const datasets::StreamSummary& stream : report.streams)
    json["streams"].push_back({{"name", stream.name},
                               {"count", stream.count},
                               {"rate_hz", stream.rate_hz},
                               {"first_s", stream.first_s},
                               {"last_s", stream.last_s},
                               {"longest_gap_s", stream.longest_gap_s}});
  for (const std::string& note : report.notes) json["notes"].push_back(report::clean_line(note));
  for (const datasets::Finding& finding : report.findings)
    json["findings"].push_back(
        {{"severity", finding.severity == datasets::Severity::kError ? "error" : "warning"},
         {"location", report::clean_line(finding.location)},
         {"text", report::clean_line(finding.text)}});
  return json.dump(2) + "\n";
}

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
  std::cout << (arguments.json ? report_json(report) : datasets::report_text(report));
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
                  {"--rig", kRigHelp, &arguments->rig_file},
                  {"--json", "Print JSON with all findings; see bench/README.md, \"Schemas\"",
                   &arguments->json}},
      .action = [arguments] { return check(*arguments); }};
}

namespace {

int print_faults() {
  report::DataTable table{.kind = "data_faults",
                          .columns = {"kind", "effect", "amount", "default", "min", "max"},
                          .rows = {},
                          .notes = {}};
  for (const datasets::FaultDescriptor& fault : datasets::fault_descriptors()) {
    const auto if_amount = [&](double value) {
      return fault.amount.empty() ? report::DataValue() : report::DataValue(value);
    };
    table.rows.push_back({std::string(fault.name), std::string(fault.summary),
                          report::data_value(std::string(fault.amount)), if_amount(fault.typical),
                          if_amount(fault.min), if_amount(fault.max)});
  }
  std::cout << report::data_json(table);
  return kExitOk;
}

int list_faults() {
  report::TableRows rows = {{"kind", "effect", "amount", "default", "range"}};
  for (const datasets::FaultDescriptor& fault : datasets::fault_descriptors()) {
    const bool has_amount = !fault.amount.empty();
    rows.push_back({std::string(fault.name), std::string(fault.summary), std::string(fault.amount),
                    has_amount ? fmt::format("{}", fault.typical) : "",
                    has_amount ? fmt::format("{} to {}", fault.min, fault.max) : ""});
  }
  std::cout << report::format_table(rows, report::TableStyle::kMarkdown);
  return kExitOk;
}

}  // namespace

Command faults_command() {
  const auto json = std::make_shared<bool>(false);
  return {.name = "faults",
          .summary = "List the sensor faults that `run --fault` injects",
          .example = "data faults",
          .options = {{"--json", report::kJsonHelp, json.get()}},
          .action = [json] { return *json ? print_faults() : list_faults(); }};
}

}  // namespace stillpoint::bench
