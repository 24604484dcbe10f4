// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/slam_system.h"

#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/config/settings.h"
#include "bench/config/toml_source.h"
#include "bench/model/json_problem.h"
#include "bench/profile/instruction_count.h"
#include "bench/record/result_values.h"
#include "bench/record/run_environment.h"
#include "bench/record/run_files.h"
#include "bench/run/run_result.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/cache/cache_space.h"
#include "datasets/open_sequence.h"
#include "datasets/sequence_export.h"
#include "datasets/synthetic/sequence/render_sequence.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string replaced(std::string text, const std::string& placeholder, const std::string& value) {
  for (std::size_t at = text.find(placeholder); at != std::string::npos;
       at = text.find(placeholder, at + value.size())) {
    text.replace(at, placeholder.size(), value);
  }
  return text;
}

fs::path exported(const RunRequest& request, ExportLayout layout) {
  if (layout == ExportLayout::kAsIs) return request.sequence;
  const std::string format = layout == ExportLayout::kTum ? "tum" : "euroc";
  fs::path folder = datasets::cache_folder() / "exports" / (request.identity.sequence_id + "-" + format) /
                    request.sequence.filename();
  if (fs::is_directory(folder)) return folder;
  const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(request.sequence);
  if (stream->info().format == format) return request.sequence;
  layout == ExportLayout::kTum ? datasets::export_tum(*stream, folder)
                               : datasets::export_euroc(*stream, folder);
  return folder;
}

std::string manifest_text(const ExternalSystem& system, const RunRequest& request) {
  Json json;
  json["schema"] = 1;
  json["system"] = {{"name", system.name}, {"version", system.version}, {"command", system.command}};
  json["sequence"] = {{"name", request.identity.sequence}, {"id", request.identity.sequence_id}};
  json["host"] = host_json(host_info());
  return json.dump(2) + "\n";
}

/// The document itself, or its member "timings" as in a result.json.
Json timings_of(const fs::path& file) {
  const Json json = Json::parse(eval::read_text_file(file));
  return json.contains("timings") ? json.at("timings") : json;
}

RunOutcome failed(Outcome outcome, const std::string& detail) {
  RunOutcome result;
  result.outcome = outcome;
  result.detail = detail;
  return result;
}

}  // namespace

ExternalSystem load_external_system(const std::string& name) {
  const TomlSource source = find_toml(name, TomlKind::kSystem);
  ExternalSystem system = with_settings(ExternalSystem{}, parse_settings(source.text, source.path));
  if (system.name.empty()) throw InputError(source.path, "has no name; add name = \"...\"");
  if (system.command.empty())
    throw InputError(source.path, "has no command; add command = [\"program\", ...]");
  system.folder = fs::absolute(source.path).parent_path().string();
  system.hash = hash_text(content_hash(source.text));
  return system;
}

ProcessSpec ExternalRun::command(const RunRequest& request) const {
  const fs::path sequence = fs::absolute(exported(request, system_.layout));
  std::vector<std::string> words;
  for (std::string word : system_.command) {
    word = replaced(word, "{sequence}", sequence.string());
    word = replaced(word, "{out}", fs::absolute(request.work).string());
    word = replaced(word, "{here}", system_.folder);
    word = replaced(word, "{seed}", std::to_string(request.identity.seed));
    words.push_back(replaced(word, "{repetition}", std::to_string(request.identity.repetition)));
  }
  ProcessSpec spec;
  spec.program = words.front();
  spec.arguments.assign(words.begin() + 1, words.end());
  return spec;
}

RunOutcome ExternalRun::outcome(const RunRequest& request, const ProcessResult& process) const {
  if (process.exit_code != 0) {
    return failed(Outcome::kCrashed, "exited with code " + std::to_string(process.exit_code) + ": " +
                                         last_line(process.messages));
  }
  const fs::path file = request.work / system_.trajectory;
  if (!fs::exists(file)) return failed(Outcome::kLost, "wrote no " + system_.trajectory);
  RunOutcome result;
  try {
    const std::string text = eval::read_text_file(file);
    OdometryRun run;
    eval::LoadedTrajectory loaded = eval::parse_tum(text, system_.trajectory, "camera");
    for (const std::string& repair : eval::repair_texts(loaded.repairs))
      result.attachments["log"] += system_.trajectory + ": " + repair + "\n";
    run.trajectory = std::move(loaded.trajectory);
    if (run.trajectory.poses.size() < 2) {
      RunOutcome lost =
          failed(Outcome::kLost, system_.trajectory + " has only one pose, which tells no error");
      lost.attachments = std::move(result.attachments);
      return lost;
    }
    const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(request.sequence);
    run.summary.frames = stream->info().frame_times.size();
    const RunResult scored = score_run(stream->info(), run);
    result.metrics = measured_metrics({.scored = measurements_of(scored).scored});
    result.attachments["trajectory"] = text;
    if (!system_.timings.empty()) {
      result.costs = module_costs(timings_of(request.work / system_.timings));
    }
    result.manifest = manifest_text(system_, request);
  } catch (const InputError& error) {
    return failed(Outcome::kCrashed, error.what());
  } catch (const nlohmann::json::exception& error) {
    return failed(Outcome::kCrashed, system_.timings + ": " + json_problem(error));
  }
  return result;
}

namespace {

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
                                       {"result.json", "result"},        {"loops.csv", "loops"}};

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

/// Manifest without the start time, so that runs with equal manifests share one blob.
std::string without_start_time(const std::string& manifest) {
  Json json = Json::parse(manifest);
  json.erase("started");
  return json.dump(2) + "\n";
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

RunOutcome OwnOdometry::outcome(const RunRequest& request, const ProcessResult& process) const {
  const fs::path result_file = request.work / "result.json";
  if (!fs::exists(result_file)) return without_result(process);
  RunOutcome outcome;
  try {
    const Json result = Json::parse(eval::read_text_file(result_file));
    outcome.outcome = outcome_of(result.at("status").get<std::string>());
    // By another process: a worker releases the runs that it interrupts itself.
    if (outcome.outcome == Outcome::kInterrupted) outcome.outcome = Outcome::kCrashed;
    if (result.at("failure").is_string()) outcome.detail = result.at("failure").get<std::string>();
    outcome.metrics = stored_metrics(result);
    outcome.costs = module_costs(result.at("timings"));
    outcome.manifest = without_start_time(eval::read_text_file(request.work / "manifest.json"));
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
