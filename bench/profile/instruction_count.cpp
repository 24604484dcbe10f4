// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/instruction_count.h"

#include <cstdlib>
#include <sstream>
#include <utility>

#include <unistd.h>

#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

fs::path find_valgrind() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder) / "valgrind";
    if (!folder.empty() && access(file.c_str(), X_OK) == 0) return file;
  }
  throw InputError("valgrind",
                   "is required to count instructions and is not in PATH; install the Debian package "
                   "\"valgrind\" (scripts/setup.sh --dev)");
}

/// Entry function of a stage, called once or twice per frame; its inclusive count is that of the stage.
struct StageFunction {
  const char* stage;
  std::string_view function;
};
constexpr StageFunction kStageFunctions[] = {
    {"tracking", "stillpoint::TrackingStage::process("},
    {"detection", "stillpoint::detect_objects("},
    {"optimization", "stillpoint::OptimizationStage::process("},
    {"optimization", "stillpoint::OptimizationStage::predict("},
};

/// Whether a callgrind name is that function, and not a part that the compiler split off.
bool is_function(std::string_view name, std::string_view function) {
  return name.starts_with(function) && name.find("[clone") == std::string_view::npos &&
         name.find(".part.") == std::string_view::npos && name.find(".cold") == std::string_view::npos;
}

/// Constant environment. Disables the threads of libraries where possible; otherwise every thread has its own
/// heap arena, and the per-thread cache of malloc is disabled.
std::vector<std::string> fixed_environment() {
  return {"PATH=/usr/bin:/bin", "LC_ALL=C", "OPENCV_FOR_THREADS_NUM=1", "OPENIMAGEIO_THREADS=1",
          "GLIBC_TUNABLES=glibc.malloc.tcache_count=0:glibc.malloc.arena_max=100"};
}

}  // namespace

ProcessSpec under_callgrind(ProcessSpec run, const fs::path& folder) {
  fs::create_directories(folder);
  std::vector<std::string> words = {"--quiet", "--tool=callgrind", "--fair-sched=yes",
                                    std::string("--callgrind-out-file=") + kCallgrindFile,
                                    run.program.string()};
  words.insert(words.end(), run.arguments.begin(), run.arguments.end());
  words.emplace_back("--deterministic-counts");
  run.program = find_valgrind();
  run.arguments = std::move(words);
  run.folder = folder;
  run.environment = fixed_environment();
  run.cores = {allowed_processors().front()};
  run.fixed_addresses = true;
  return run;
}

std::vector<StageInstructions> stage_instructions(const CallgrindCounts& counts, const std::string& place) {
  std::vector<StageInstructions> stages;
  for (const auto& [stage, function] : kStageFunctions) {
    if (stages.empty() || stages.back().stage != stage) stages.push_back({.stage = stage, .count = 0});
    for (const auto& [name, count] : counts.inclusive) {
      if (is_function(name, function)) stages.back().count += count;
    }
  }
  if (stages.front().count == 0) {
    throw InputError(place, "contains no stage of the odometry; is the binary stripped of its symbols?");
  }
  return stages;
}

std::vector<Metric> instruction_metrics(const std::vector<StageInstructions>& stages) {
  Measurements measurements;
  for (const auto& [stage, count] : stages) measurements.instructions[stage] = count;
  return measured_metrics(measurements);
}

std::vector<StageInstructions> read_instructions(const fs::path& folder) {
  const fs::path file = folder / kCallgrindFile;
  return stage_instructions(parse_callgrind(eval::read_text_file(file), file.string()), file.string());
}

}  // namespace stillpoint::bench
