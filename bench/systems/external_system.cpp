// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/external_system.h"

#include <nlohmann/json.hpp>

#include "bench/config/apply_settings.h"
#include "bench/config/toml_source.h"
#include "bench/model/json_problem.h"
#include "bench/record/host_info.h"
#include "bench/record/result_values.h"
#include "bench/run/run_result.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/open_sequence.h"
#include "datasets/sequence_export.h"
#include "datasets/synthetic/sequence/sequence_cache.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

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
  fs::path folder = synth::cache_folder() / "exports" / (request.identity.sequence_id + "-" + format) /
                    request.sequence.filename();
  if (fs::is_directory(folder)) return folder;
  const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(request.sequence);
  if (stream->info().format == format) return request.sequence;
  layout == ExportLayout::kTum ? datasets::export_tum(*stream, folder)
                               : datasets::export_euroc(*stream, folder);
  return folder;
}

std::string manifest_text(const ExternalSystem& system, const RunRequest& request) {
  nlohmann::ordered_json json;
  json["schema"] = 1;
  json["system"] = {{"name", system.name}, {"version", system.version}, {"command", system.command}};
  json["sequence"] = {{"name", request.identity.sequence}, {"id", request.identity.sequence_id}};
  json["host"] = host_json(host_info());
  return json.dump(2) + "\n";
}

/// The document itself, or its member "timings" as in a result.json.
nlohmann::ordered_json timings_of(const fs::path& file) {
  const nlohmann::ordered_json json = nlohmann::ordered_json::parse(eval::read_text_file(file));
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

}  // namespace stillpoint::bench
