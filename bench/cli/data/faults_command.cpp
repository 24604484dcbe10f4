// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "datasets/faults/sensor_fault.h"
#include "reports/tables/text_table.h"

namespace stillpoint::bench {
namespace {

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
  return {.name = "faults",
          .summary = "List the sensor faults that `run --fault` injects",
          .example = "data faults",
          .action = list_faults};
}

}  // namespace stillpoint::bench
