// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/own_odometry.h"

#include <cstring>

#include <nlohmann/json.hpp>

#include "bench/profile/instruction_count.h"
#include "bench/record/build_info.h"
#include "bench/record/result_values.h"
#include "bench/run/heartbeat.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kBadInput = 2;  // exit codes of the program, see bench/cli/command_line.h
constexpr std::string_view kErrorPrefix = "stillpoint: error: ";

/// Files of a run, and under what name a store keeps them.
struct KeptFile {
  const char* file;
  const char* kind;
};
constexpr KeptFile kKeptFiles[] = {{"trajectory.tum", "trajectory"}, {"timings.csv", "timings"},
                                   {"frames.csv", "frames"},         {"counters.csv", "counters"},
                                   {"stacks.folded", "stacks"},      {"result.json", "result"}};

std::string message_of(const ProcessEnd& end) {
  const std::string line = last_line(end.messages);
  return line.starts_with(kErrorPrefix) ? line.substr(kErrorPrefix.size()) : line;
}

RunOutcome without_result(const ProcessEnd& end) {
  RunOutcome outcome;
  const bool out_of_memory = end.messages.find("bad_alloc") != std::string::npos;
  outcome.outcome = end.exit_code == kBadInput ? Outcome::kBadData
                    : out_of_memory            ? Outcome::kOutOfMemory
                                               : Outcome::kCrashed;
  outcome.detail = end.exit_code == kBadInput
                       ? message_of(end)
                       : "ended with " + std::to_string(end.exit_code) + ": " + message_of(end);
  return outcome;
}

/// 000042.jpg becomes "picture:000042".
void append_pictures(RunOutcome& outcome, const fs::path& folder) {
  if (!fs::exists(folder)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    outcome.attachments[std::string(kPictureKind) + entry.path().stem().string()] =
        read_text_file(entry.path());
}

bool counts_instructions(const RunRequest& request) { return request.run.identity.kind == "instructions"; }

/// Under valgrind times say nothing; instructions take their place.
void replace_times(RunOutcome& outcome, const RunRequest& request) {
  std::erase_if(outcome.metrics, [](const Metric& metric) { return metric.name == "wall_s"; });
  outcome.costs.clear();
  outcome.attachments.erase("timings");
  outcome.attachments.erase("result");
  const std::vector<Metric> counts = instruction_metrics(read_instructions(request.work));
  outcome.metrics.insert(outcome.metrics.end(), counts.begin(), counts.end());
}

/// Runs at other times share their manifest.
std::string timeless(const std::string& manifest) {
  Json json = Json::parse(manifest);
  json.erase("started");
  return json.dump(2) + "\n";
}

}  // namespace

ProcessSpec OwnOdometry::command(const RunRequest& request) const {
  const ConfigRequest& config = request.run.config;
  const bool counted = counts_instructions(request);
  const fs::path folder = counted ? "." : request.work;  // a name that is the same in every run
  ProcessSpec spec;
  spec.program = request.run.program.empty() ? own_program() : request.run.program;
  spec.arguments = {"run",         request.sequence.string(),
                    "--config",    config.base,
                    "--variant",   config.variant,
                    "--mode",      request.run.identity.mode,
                    "--out",       folder.string(),
                    "--heartbeat", (folder / kHeartbeatFile).string()};
  if (request.run.max_frames > 0) {
    spec.arguments.insert(spec.arguments.end(), {"--max-frames", std::to_string(request.run.max_frames)});
  }
  for (const std::string& setting : config.settings) {
    spec.arguments.insert(spec.arguments.end(), {"--set", setting});
  }
  if (request.pictures > 0 && !counted)
    spec.arguments.insert(spec.arguments.end(), {"--pictures", std::to_string(request.pictures)});
  if (!counted) return spec;
  spec.arguments.insert(spec.arguments.end(), {"--sequence-id", request.run.identity.sequence_id});
  return under_callgrind(std::move(spec), request.work);
}

RunOutcome OwnOdometry::outcome(const RunRequest& request, const ProcessEnd& end) const {
  const fs::path result_file = request.work / "result.json";
  if (!fs::exists(result_file)) return without_result(end);
  RunOutcome outcome;
  try {
    const Json result = Json::parse(read_text_file(result_file));
    outcome.outcome = result.at("status") == "ok" ? Outcome::kOk : Outcome::kLost;
    if (result.at("failure").is_string()) outcome.detail = result.at("failure").get<std::string>();
    outcome.metrics = score_metrics(result);
    outcome.costs = module_costs(result.at("timings"));
    outcome.manifest = timeless(read_text_file(request.work / "manifest.json"));
  } catch (const Json::exception& error) {
    throw InputError(result_file.string(), std::string("is no result file: ") + error.what());
  }
  for (const KeptFile& kept : kKeptFiles) {
    if (fs::exists(request.work / kept.file))
      outcome.attachments[kept.kind] = read_text_file(request.work / kept.file);
  }
  append_pictures(outcome, request.work / "pictures");
  if (counts_instructions(request)) replace_times(outcome, request);
  return outcome;
}

std::string build_name() {
  const BuildInfo& build = build_info();
  return build.git_commit + (build.git_dirty ? "+" + build.git_changes : "");
}

}  // namespace stillpoint
