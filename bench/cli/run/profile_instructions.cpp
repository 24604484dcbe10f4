// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/profile_instructions.h"

#include <algorithm>
#include <iostream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "bench/cli/command_line.h"
#include "bench/cli/interrupt.h"
#include "bench/process/process_pool.h"
#include "bench/profile/instruction_count.h"
#include "bench/record/output_folder.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"
#include "reports/tables/text_table.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using FunctionCount = std::pair<std::string, std::int64_t>;

constexpr std::size_t kListedFunctions = 15;
constexpr std::size_t kListedCharacters = 100;

ProcessSpec run_of(const InstructionRequest& request) {
  ProcessSpec run;
  run.program = executable_path();
  run.arguments = {"run",           fs::absolute(request.sequence).string(),
                   "--config",      request.config.base,
                   "--variant",     request.config.variant,
                   "--out",         ".",
                   "--max-frames",  std::to_string(request.frames),
                   "--sequence-id", "unused"};
  for (const std::string& setting : request.config.settings) {
    run.arguments.insert(run.arguments.end(), {"--set", setting});
  }
  return under_callgrind(std::move(run), fs::absolute(request.folder));
}

/// Functions with the largest self counts.
std::vector<FunctionCount> largest_self_counts(const CallgrindCounts& counts) {
  std::vector<FunctionCount> functions(counts.self.begin(), counts.self.end());
  std::stable_sort(functions.begin(), functions.end(),
                   [](const FunctionCount& a, const FunctionCount& b) { return a.second > b.second; });
  functions.resize(std::min(functions.size(), kListedFunctions));
  return functions;
}

std::string in_millions(std::int64_t count, double divisor) {
  return fmt::format("{:.3f}", 1e-6 * static_cast<double>(count) / divisor);
}

void print(const std::vector<StageInstructions>& stages, const CallgrindCounts& counts, int frames) {
  report::TableRows table = {{"stage", "instructions", "million per frame"}};
  std::int64_t total = 0;
  for (const auto& [stage, count] : stages) {
    table.push_back({stage, fmt::format("{}", count), in_millions(count, frames)});
    total += count;
  }
  table.push_back({"all stages", fmt::format("{}", total), in_millions(total, frames)});
  std::cout << report::format_table(table, report::TableStyle::kText)
            << "\nfunctions with the largest self counts, whole program, millions (may vary between runs):\n";
  for (const auto& [function, count] : largest_self_counts(counts)) {
    std::cout << fmt::format("{:>12}  {}\n", in_millions(count, 1.0), function.substr(0, kListedCharacters));
  }
}

Json json_of(const InstructionRequest& request, const std::vector<StageInstructions>& stages,
             const CallgrindCounts& counts) {
  Json json = {{"sequence", request.name}, {"base", request.config.base}, {"variant", request.config.variant},
               {"frames", request.frames}, {"stages", Json::object()},    {"functions", Json::array()}};
  for (const auto& [stage, count] : stages) json["stages"][stage] = count;
  for (const auto& [function, count] : largest_self_counts(counts)) {
    json["functions"].push_back({{"name", function}, {"self", count}});
  }
  return json;
}

}  // namespace

int profile_instructions(const InstructionRequest& request) {
  const ProcessSpec spec = run_of(request);
  spdlog::info("executing {} frames under callgrind, about 50 times slower than normal", request.frames);
  ProcessPool pool(interrupt_requested);
  pool.start(0, spec);
  const ProcessResult end = pool.wait_next()->second;
  if (interrupt_requested()) return kExitInterrupted;
  const fs::path file = request.folder / kCallgrindFile;
  if (end.signal != 0 || end.exit_code > kExitFindings) {
    throw InputError(request.sequence.string(), "the run under callgrind failed: " + last_line(end.messages));
  }
  const CallgrindCounts counts = parse_callgrind(eval::read_text_file(file), file.string());
  const std::vector<StageInstructions> stages = stage_instructions(counts, file.string());
  write_files(request.folder, {{"instructions.json", json_of(request, stages, counts).dump(2) + "\n"}});
  print(stages, counts, request.frames);
  std::cout << fmt::format("{} (open callgrind.out in KCachegrind)\n", request.folder.string());
  return kExitOk;
}

}  // namespace stillpoint::bench
