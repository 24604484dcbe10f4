// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/run_origin.h"

#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/replicates.h"
#include "core/base/content_hash.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::json;

constexpr const char* kUnknownHost = "unknown machine";

std::string text_at(const Json& json, const char* part, const char* name) {
  const auto found = json.find(part);
  if (found == json.end() || !found->is_object()) return "";
  const auto value = found->find(name);
  return value != found->end() && value->is_string() ? value->get<std::string>() : "";
}

std::string host_class(const Json& manifest) {
  const std::string cpu = text_at(manifest, "host", "cpu");
  if (cpu.empty()) return kUnknownHost;
  const auto count = manifest.at("host").find("logical_cpus");
  if (count == manifest.at("host").end() || !count->is_number_unsigned()) return cpu;
  return fmt::format("{}, {} processors", cpu, count->get<unsigned>());
}

/// Hash of the config in a manifest without the keys that end with "seed"; empty if it has none.
std::string config_class(const Json& manifest) {
  const auto config = manifest.find("config");
  if (config == manifest.end() || !config->is_object()) return "";
  const auto resolved = config->find("resolved");
  if (resolved == config->end() || !resolved->is_object()) return "";
  Json values = Json::object();
  for (const auto& [key, value] : resolved->items()) {
    if (!key.ends_with("seed")) values[key] = value;
  }
  return hash_text(content_hash(values.dump()));
}

RunOrigin origin_of(const Json& manifest, const std::string& build) {
  const std::string git_commit = text_at(manifest, "build", "git_commit");
  const std::string changes = text_at(manifest, "build", "git_changes");
  const bool is_known = !git_commit.empty() && git_commit != "unknown";
  // Programs run by the gate are identified by content hash; the history uses their commit.
  return {.commit = is_known ? git_commit + (changes.empty() ? "" : "+" + changes) : build,
          .time = text_at(manifest, "build", "git_time"),
          .host = host_class(manifest),
          .config = config_class(manifest)};
}

}  // namespace

std::vector<RunOrigin> run_origins(const Store& store, std::span<const StoredRun> runs) {
  std::vector<RunOrigin> origins;
  std::map<std::string, std::string> configs;  // by config hash without the perturbation
  for (const StoredRun& run : runs) {
    const Json manifest = Json::parse(store.manifest(run), nullptr, false);
    const std::string host = origins.empty() ? kUnknownHost : origins.back().host;
    origins.push_back(manifest.is_object() ? origin_of(manifest, run.identity.build)
                                           : RunOrigin{.commit = run.identity.build, .host = host});
    if (!origins.back().config.empty())
      configs[std::string(unperturbed_hash(run.identity.config_hash))] = origins.back().config;
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!origins[i].config.empty()) continue;
    const auto found = configs.find(std::string(unperturbed_hash(runs[i].identity.config_hash)));
    if (found != configs.end()) origins[i].config = found->second;
  }
  return origins;
}

}  // namespace stillpoint::bench
