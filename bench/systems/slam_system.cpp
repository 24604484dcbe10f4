// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/slam_system.h"

#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/json_problem.h"
#include "bench/profile/instruction_count.h"
#include "bench/record/result_values.h"
#include "bench/record/run_environment.h"
#include "bench/record/run_files.h"
#include "bench/run/run_result.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kBadInput = 2;  // exit codes of the program, see bench/cli/command_line.h
constexpr std::string_view kErrorPrefix = "stillpoint: error: ";

/// Output files of a run, and their attachment names in the store.
struct StoredFile {
  const char* file;
  const char* kind;
};
constexpr StoredFile kStoredFiles[] = {{"trajectory.tum", "trajectory"}, {"timings.csv", "timings"},
                                       {"frames.csv", "frames"},         {"counters.csv", "counters"},
                                       {"status.csv", "claims"},         {"stacks.folded", "stacks"},
                                       {"result.json", "result"},        {"loops.csv", "loops"},
                                       {"landmarks.csv", "landmarks"},   {"surfaces.ply", "surfaces"}};

std::string message_of(const ProcessResult& process) {
  const std::string line = last_line(process.messages);
  return line.starts_with(kErrorPrefix) ? line.substr(kErrorPrefix.size()) : line;
}

RunOutcome without_result(const ProcessResult& process) {
  RunOutcome outcome;
  const bool out_of_memory = process.messages.find("bad_alloc") != std::string::npos;
  outcome.outcome = process.exit_code == kBadInput ? Outcome::kBadData
                    : out_of_memory                ? Outcome::kOutOfMemory
                                                   : Outcome::kCrashed;
  outcome.detail = process.exit_code == kBadInput
                       ? message_of(process)
                       : "exited with code " + std::to_string(process.exit_code) +
                             " without writing result.json: " + message_of(process);
  return outcome;
}

/// The stored files and the annotated images by attachment name; images/000042.jpg becomes "image:000042".
std::map<std::string, std::string> read_attachments(const fs::path& folder) {
  std::map<std::string, std::string> attachments;
  for (const StoredFile& stored : kStoredFiles) {
    if (fs::exists(folder / stored.file))
      attachments[stored.kind] = eval::read_text_file(folder / stored.file);
  }
  if (!fs::exists(folder / "images")) return attachments;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "images"))
    attachments[std::string(kImageKind) + entry.path().stem().string()] = eval::read_text_file(entry.path());
  return attachments;
}

bool counts_instructions(const RunRequest& request) { return request.identity.kind == "instructions"; }

/// Times under valgrind are meaningless; they are replaced by instruction counts.
RunOutcome with_instruction_counts(RunOutcome outcome, const fs::path& folder) {
  std::erase_if(outcome.metrics, [](const Metric& metric) { return metric.name == metric_id::kWallTime; });
  outcome.costs.clear();
  outcome.attachments.erase("timings");
  outcome.attachments.erase("result");
  const std::vector<Metric> counts = instruction_metrics(read_instructions(folder));
  outcome.metrics.insert(outcome.metrics.end(), counts.begin(), counts.end());
  return outcome;
}

/// Manifest of the program without the start time, so that runs with equal manifests share one blob. The time
/// of its commit is that of the request, if any: along a history, commits are ordered by it.
std::string stored_manifest(const std::string& manifest, const RunRequest& request) {
  Json json = Json::parse(manifest);
  json.erase("started");
  if (!request.commit_time.empty()) json["build"]["git_time"] = request.commit_time;
  return json.dump(2) + "\n";
}

/// Why the errors of a run that succeeded may mislead; empty if there is no reason. A fault of the run may
/// remove images.
std::string doubt_of(const Json& result, const RunRequest& request) {
  std::string doubt = error_doubt(result.value("warnings", std::vector<std::string>{}));
  const Json skipped = result.value("skipped_frames", Json::array());
  if (skipped.empty() || !request.fault.empty()) return doubt;
  if (!doubt.empty()) doubt += "; ";
  return doubt + fmt::format("{} could not be read, the first: {}", counted(skipped.size(), "frame"),
                             skipped.front().at("reason").get<std::string>());
}

}  // namespace

ProcessSpec OwnOdometry::command(const RunRequest& request) const {
  const ConfigRequest& config = request.config;
  const bool counted = counts_instructions(request);
  const fs::path folder = counted ? "." : request.work;  // the same command line in every run
  ProcessSpec spec;
  spec.program = request.program.empty() ? executable_path() : request.program;
  spec.arguments = {"run",         request.sequence.string(),
                    "--config",    config.base,
                    "--variant",   config.variant,
                    "--mode",      request.identity.mode,
                    "--out",       folder.string(),
                    "--heartbeat", (folder / kHeartbeatFile).string()};
  if (request.max_frames > 0) {
    spec.arguments.insert(spec.arguments.end(), {"--max-frames", std::to_string(request.max_frames)});
  }
  if (!request.frame_cache) spec.arguments.emplace_back("--no-frame-cache");
  if (request.start_s > 0.0) {
    spec.arguments.insert(spec.arguments.end(), {"--start", fmt::format("{:.6f}", request.start_s)});
  }
  if (request.gray_noise > 0)
    spec.arguments.insert(spec.arguments.end(), {"--gray-noise", std::to_string(request.gray_noise)});
  if (!request.fault.empty()) spec.arguments.insert(spec.arguments.end(), {"--fault", request.fault});
  for (const std::string& setting : config.settings) {
    spec.arguments.insert(spec.arguments.end(), {"--set", setting});
  }
  if (request.images > 0 && !counted)
    spec.arguments.insert(spec.arguments.end(), {"--images", std::to_string(request.images)});
  if (!counted) return spec;
  spec.arguments.insert(spec.arguments.end(), {"--sequence-id", request.identity.sequence_id});
  return under_callgrind(std::move(spec), request.work);
}

std::string OwnOdometry::manifest(const RunRequest& request) const {
  if (request.commit_time.empty()) return "";
  Json json;
  json["schema"] = 1;
  json["build"] = {{"git_commit", request.identity.build}, {"git_time", request.commit_time}};
  json["host"] = host_json(host_info());
  return json.dump(2) + "\n";
}

RunOutcome OwnOdometry::outcome(const RunRequest& request, const ProcessResult& process) const {
  const fs::path result_file = request.work / "result.json";
  if (!fs::exists(result_file)) return without_result(process);
  RunOutcome outcome;
  try {
    const Json result = Json::parse(eval::read_text_file(result_file));
    outcome.outcome = outcome_of(result.at("status").get<std::string>());
    // By another process: a worker releases the runs that it interrupts itself.
    if (outcome.outcome == Outcome::kInterrupted) outcome.outcome = Outcome::kCrashed;
    outcome.detail = result.at("failure").is_string() ? result.at("failure").get<std::string>()
                                                      : doubt_of(result, request);
    outcome.metrics = stored_metrics(result);
    outcome.costs = module_costs(result.at("timings"));
    outcome.manifest = stored_manifest(eval::read_text_file(request.work / "manifest.json"), request);
  } catch (const Json::exception& error) {
    throw InputError(result_file.string(), "is not a result file: " + json_problem(error));
  }
  outcome.attachments = read_attachments(request.work);
  return counts_instructions(request) ? with_instruction_counts(std::move(outcome), request.work) : outcome;
}

std::string build_name() {
  const BuildInfo& build = build_info();
  return build.git_commit + (build.git_dirty ? "+" + build.git_changes : "");
}

}  // namespace stillpoint::bench
