// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/maintenance/store_export.h"

#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/json_problem.h"
#include "bench/model/metrics.h"
#include "bench/store/schema.h"
#include "bench/store/store.h"
#include "bench/store/store_writer.h"
#include "core/base/error.h"
#include "eval/io/base64.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kExportVersion = 4;
constexpr const char* kVersionKey = "stillpoint_store";
constexpr const char* kTrajectoryKind = "trajectory";

Json identity_json(const RunIdentity& identity) {
  return {{"system", identity.system},
          {"variant", identity.variant},
          {"sequence", identity.sequence},
          {"sequence_id", identity.sequence_id},
          {"config_hash", identity.config_hash},
          {"build", identity.build},
          {"mode", identity.mode},
          {"kind", identity.kind},
          {"cores", identity.cores},
          {"seed", identity.seed},
          {"repetition", identity.repetition},
          {"axis", identity.axis},
          {"axis_value", identity.axis_value}};
}

RunIdentity identity_of(const Json& json) {
  return {.system = json.at("system"),
          .variant = json.at("variant"),
          .sequence = json.at("sequence"),
          .sequence_id = json.at("sequence_id"),
          .config_hash = json.at("config_hash"),
          .build = json.at("build"),
          .mode = json.at("mode"),
          .kind = json.at("kind"),
          .cores = json.at("cores"),
          .seed = json.at("seed"),
          .repetition = json.at("repetition"),
          .axis = json.at("axis"),
          .axis_value = json.at("axis_value")};
}

Json acceptance_json(const Acceptance& acceptance) {
  return {{"commit", acceptance.commit},   {"metric", acceptance.metric},
          {"variant", acceptance.variant}, {"sequence", acceptance.sequence},
          {"reason", acceptance.reason},   {"accepted", acceptance.accepted}};
}

Acceptance acceptance_of(const Json& json) {
  return {json.at("commit"),   json.at("metric"), json.at("variant"),
          json.at("sequence"), json.at("reason"), json.at("accepted")};
}

/// JSON has no infinity: the value is null, and the mark "not_finite" names it.
Json metric_json(const Metric& metric) {
  Json json = {
      {"name", metric.name}, {"protocol", metric.protocol}, {"unit", metric.unit}, {"value", metric.value}};
  if (!std::isfinite(metric.value)) {
    json["value"] = nullptr;
    json["not_finite"] = metric.value > 0.0 ? "inf" : "-inf";
  }
  return json;
}

double metric_value_of(const Json& metric) {
  const Json& value = metric.at("value");
  // Older versions wrote the null without the mark.
  if (value.is_null() && metric.value("not_finite", "inf") == "-inf")
    return -std::numeric_limits<double>::infinity();
  return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

/// JSON has no bytes that are not UTF-8, as those of images and of logs of some programs.
Json attachment_json(const std::string& content) {
  if (is_utf8(content)) return content;
  return {{"base64", eval::base64(content)}};
}

std::string attachment_of(const Json& attachment) {
  if (attachment.is_object()) return eval::bytes_of_base64(attachment.at("base64").get<std::string>());
  return attachment.get<std::string>();
}

/// Versions 1 and 2 wrote U+FFFD in place of most bytes of images.
bool is_lost_image(const std::string& kind, const std::string& content) {
  return kind.starts_with(kImageKind) && content.find("\xEF\xBF\xBD") != std::string::npos &&
         is_utf8(content);
}

Json run_json(const Store& store, const StoredRun& run, ExportExtent extent) {
  Json json = {{"key", run.key},
               {"identity", identity_json(run.identity)},
               {"outcome", outcome_name(run.outcome)},
               {"detail", run.detail},
               {"started", run.started},
               {"ended", run.ended},
               {"committed", run.committed},
               {"machine", run.machine}};
  json["metrics"] = Json::array();
  for (const Metric& metric : run.metrics) json["metrics"].push_back(metric_json(metric));
  json["costs"] = Json::array();
  for (const ModuleCost& cost : run.costs) {
    json["costs"].push_back({{"module", cost.module},
                             {"per", cost.per},
                             {"calls", cost.calls},
                             {"mean_ms", cost.mean_ms},
                             {"median_ms", cost.median_ms},
                             {"p95_ms", cost.p95_ms},
                             {"max_ms", cost.max_ms}});
  }
  const auto trajectory = run.blobs.find(kTrajectoryKind);
  json["trajectory_hash"] = trajectory == run.blobs.end() ? "" : trajectory->second;
  const bool everything = extent == ExportExtent::kEverything;
  json["attachments"] = Json::object();
  for (const auto& [kind, blob] : run.blobs) {
    if (everything) json["attachments"][kind] = attachment_json(store.attachment(run, kind));
  }
  json["manifest"] = everything ? store.manifest(run) : "";
  return json;
}

/// An export of numbers has no manifests. The store reads commit time and machine from them, without which
/// times of two machines would be compared.
std::string manifest_of(const Json& run) {
  std::string manifest = run.at("manifest");
  if (!manifest.empty()) return manifest;
  Json origin;
  if (const std::string committed = run.value("committed", ""); !committed.empty())
    origin["build"] = {{"git_time", committed}};
  if (const std::string machine = run.value("machine", ""); !machine.empty())
    origin["host"] = {{"cpu", machine}};  // with the number of processors
  return origin.is_null() ? "" : origin.dump(1) + "\n";
}

RunOutcome outcome_of_json(const Json& json) {
  RunOutcome outcome;
  outcome.outcome = outcome_of(json.at("outcome").get<std::string>());
  outcome.detail = json.at("detail");
  for (const Json& metric : json.at("metrics")) {
    const char* protocol = metric.contains("protocol") ? "protocol" : kOldProtocolName;
    outcome.metrics.push_back(
        {metric.at("name"), metric.at(protocol), metric.at("unit"), metric_value_of(metric)});
  }
  for (const Json& cost : json.at("costs")) {
    outcome.costs.push_back({cost.at("module"), cost.at("per"), cost.at("calls"), cost.at("mean_ms"),
                             cost.at("median_ms"), cost.at("p95_ms"), cost.at("max_ms")});
  }
  for (const auto& [name, attachment] : json.at("attachments").items()) {
    const std::string kind = current_kind(name);
    std::string content = attachment_of(attachment);
    if (!is_lost_image(kind, content)) outcome.attachments[kind] = std::move(content);
  }
  outcome.manifest = manifest_of(json);
  outcome.started = json.at("started");
  outcome.ended = json.at("ended");
  return outcome;
}

/// @throws InputError if a metric is impossible: a negative error would count as an improvement
RunOutcome checked_outcome(const Json& run, const std::string& place) {
  RunOutcome outcome = outcome_of_json(run);
  for (const Metric& metric : outcome.metrics) {
    if (const std::string_view why = impossibility(metric); !why.empty())
      throw InputError(place, fmt::format("run {}: metric {} is {:g}; it cannot be {}",
                                          run.at("key").get<std::string>(), metric.name, metric.value, why));
  }
  return outcome;
}

/// Parses an exported text and calls `read` with it. @throws InputError for every fault of the text
template <class Read>
auto read_export(const std::string& text, const std::string& place, const Read& read) {
  try {
    const Json json = Json::parse(text);
    if (json.at(kVersionKey).get<int>() > kExportVersion)
      throw InputError(place, "was written by a newer version; use that version");
    return read(json);
  } catch (const Json::exception& error) {
    throw InputError(place, "is not an exported store: " + json_problem(error));
  }
}

}  // namespace

std::string exported_beginning() { return std::string("{\n \"") + kVersionKey + "\""; }

std::string export_store(const fs::path& file, ExportExtent extent) {
  const Store store(file);
  Json json;
  json[kVersionKey] = kExportVersion;
  json["plans"] = Json::array();
  for (const StoredPlan& plan : store.plans()) {
    json["plans"].push_back(
        {{"name", plan.name}, {"title", plan.title}, {"text", plan.text}, {"run_keys", plan.run_keys}});
  }
  json["runs"] = Json::array();
  for (const StoredRun& run : store.runs()) json["runs"].push_back(run_json(store, run, extent));
  json["accepted"] = Json::array();
  for (const Acceptance& acceptance : store.acceptances())
    json["accepted"].push_back(acceptance_json(acceptance));
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

MergeReport import_store(const std::string& text, const std::string& place, const fs::path& into) {
  return read_export(text, place, [&](const Json& json) {
    std::vector<std::pair<RunIdentity, RunOutcome>> runs;  // all are read before one is written
    for (const Json& run : json.at("runs"))
      runs.emplace_back(identity_of(run.at("identity")), checked_outcome(run, place));
    RunMerger merger(into);
    for (const auto& [identity, outcome] : runs) merger.add(identity, outcome);
    for (const Json& plan : json.at("plans")) {
      merger.writer().record_plan({.name = plan.at("name"),
                                   .title = plan.at("title"),
                                   .text = plan.at("text"),
                                   .run_keys = plan.at("run_keys").get<std::vector<std::string>>()});
    }
    std::vector<Acceptance> acceptances;
    for (const Json& accepted : json.value("accepted", Json::array()))
      acceptances.push_back(acceptance_of(accepted));
    write_acceptances(into, acceptances);
    return merger.report();
  });
}

std::vector<StoredRun> exported_runs(const std::string& text, const std::string& place) {
  return read_export(text, place, [&](const Json& json) {
    std::vector<StoredRun> runs;
    for (const Json& run : json.at("runs")) {
      const RunOutcome outcome = checked_outcome(run, place);
      runs.push_back({.key = run.at("key"),
                      .identity = identity_of(run.at("identity")),
                      .outcome = outcome.outcome,
                      .detail = outcome.detail,
                      .started = run.at("started"),
                      .ended = run.at("ended"),
                      .committed = run.value("committed", ""),
                      .machine = run.value("machine", ""),
                      .metrics = outcome.metrics,
                      .costs = outcome.costs});
      // Not written by version 3.
      if (std::string hash = run.value("trajectory_hash", ""); !hash.empty())
        runs.back().blobs[kTrajectoryKind] = std::move(hash);
    }
    return runs;
  });
}

}  // namespace stillpoint::bench
