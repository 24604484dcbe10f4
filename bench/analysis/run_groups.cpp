// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/run_groups.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/model/metrics.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::json;

constexpr const char* kUnknownHost = "unknown machine";
constexpr const char* kAllBuilds = "all";
constexpr std::size_t kMaxListed = 8;

std::string text_at(const Json& json, const char* part, const char* name) {
  const auto found = json.find(part);
  if (found == json.end() || !found->is_object()) return "";
  const auto value = found->find(name);
  return value != found->end() && value->is_string() ? value->get<std::string>() : "";
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

RunOrigin origin_of(const Json& manifest, const StoredRun& run) {
  const std::string git_commit = text_at(manifest, "build", "git_commit");
  const std::string changes = text_at(manifest, "build", "git_changes");
  const bool is_known = !git_commit.empty() && git_commit != "unknown";
  // Programs run by the gate are identified by content hash; the history uses their commit.
  return {.commit = is_known ? git_commit + (changes.empty() ? "" : "+" + changes) : run.identity.build,
          .time = run.committed,
          .host = run.machine.empty() ? kUnknownHost : run.machine,
          .config = config_class(manifest)};
}

}  // namespace

RunOrigins run_origins(const Store& store, std::span<const StoredRun> runs) {
  RunOrigins stated;
  std::unordered_map<std::string, std::optional<RunOrigin>> known;  // by manifest and build
  std::unordered_map<std::string, std::string> configs;             // by config hash without the perturbation
  const auto located = std::ranges::find_if(runs, [](const StoredRun& run) { return !run.machine.empty(); });
  std::string host = located == runs.end() ? kUnknownHost : located->machine;
  for (const StoredRun& run : runs) {
    const auto [entry, is_new] = known.try_emplace(run.manifest_hash + " " + run.identity.build);
    if (is_new) {
      const Json manifest = Json::parse(store.manifest(run), nullptr, false);
      if (manifest.is_object()) entry->second = origin_of(manifest, run);
    }
    const RunOrigin origin =
        entry->second.value_or(RunOrigin{.commit = run.identity.build, .time = run.committed, .host = host});
    stated.push_back(origin);
    host = origin.host;
    if (!origin.config.empty())
      configs[std::string(unperturbed_hash(run.identity.config_hash))] = origin.config;
  }
  RunOrigins origins;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    RunOrigin origin = stated[i];
    const auto found = configs.find(std::string(unperturbed_hash(runs[i].identity.config_hash)));
    if (origin.config.empty() && found != configs.end()) origin.config = found->second;
    origins.push_back(origin);
  }
  return origins;
}

namespace {

/// Builds, the newest first: by commit time, or the first run without one, then by the first run.
/// @param system only its builds; empty: those of all systems
std::vector<std::string> builds_of(std::span<const StoredRun> runs, const std::string& system) {
  struct BuildTime {
    std::string committed;
    std::string first_run;
    std::int64_t id = 0;
  };
  std::map<std::string, BuildTime> times;
  for (const StoredRun& run : runs) {
    if (!system.empty() && run.identity.system != system) continue;
    const auto [entry, is_new] = times.insert({run.identity.build, {run.committed, run.started, run.id}});
    BuildTime& time = entry->second;
    if (time.committed.empty()) time.committed = run.committed;
    if (!is_new)
      std::tie(time.first_run, time.id) =
          std::min(std::tuple(time.first_run, time.id), std::tuple(run.started, run.id));
  }
  std::vector<std::tuple<std::string, std::string, std::int64_t, std::string>> order;
  order.reserve(times.size());
  for (const auto& [build, time] : times) {
    order.emplace_back(time.committed.empty() ? time.first_run : time.committed, time.first_run, time.id,
                       build);
  }
  std::sort(order.rbegin(), order.rend());
  std::vector<std::string> builds;
  builds.reserve(order.size());
  for (const auto& entry : order) builds.push_back(std::get<3>(entry));
  return builds;
}

std::string listed(std::vector<std::string> names) {
  const std::size_t count = names.size();
  if (count > kMaxListed) names.resize(kMaxListed);
  return fmt::format("{}{}", fmt::join(names, ", "), count > kMaxListed ? ", ..." : "");
}

/// The build that a name or a prefix refers to.
std::string chosen_build(const std::vector<std::string>& builds, const std::string& name,
                         const std::string& place) {
  std::vector<std::string> found;
  for (const std::string& build : builds) {
    if (build == name) return build;
    const bool is_changed = build.find('+') != std::string::npos && name.find('+') == std::string::npos;
    if (build.starts_with(name) && !is_changed) found.push_back(build);
  }
  if (found.size() == 1) return found.front();
  const std::string problem = found.empty() ? "there is no run of build" : "several builds begin with";
  throw InputError(place, fmt::format("{} \"{}\"; existing builds, the newest first: {}", problem, name,
                                      listed(found.empty() ? builds : found)));
}

std::string mode_text(const RunIdentity& identity) {
  return identity.mode + ", " + identity.kind + (identity.cores.empty() ? "" : ", cores " + identity.cores);
}

/// Within which a variant has one config: build, machine, mode, system, variant, sweep axis, its value.
using ConfigScope =
    std::tuple<std::string, std::string, std::string, std::string, std::string, std::string, double>;

ConfigScope scope_of(const RunIdentity& identity, const RunOrigin& origin) {
  return {identity.build,   origin.host,   mode_text(identity), identity.system,
          identity.variant, identity.axis, identity.axis_value};
}

/// Start and id of a run: later runs compare larger.
using RunOrder = std::pair<std::string, std::int64_t>;

using NewestConfigs = std::map<ConfigScope, std::pair<RunOrder, std::string>>;  // newest run, its config

NewestConfigs newest_configs(std::span<const StoredRun> runs, const RunOrigins& origins) {
  NewestConfigs newest;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    auto& config = newest[scope_of(runs[i].identity, origins[i])];
    if (origins[i].config.empty()) continue;
    config = std::max(config, {RunOrder(runs[i].started, runs[i].id), origins[i].config});
  }
  return newest;
}

/// What a sequence consists of, and of which a group has one version: sequence, seed, sweep axis, its value.
using DataScope = std::tuple<std::string, std::int64_t, std::string, double>;

DataScope data_scope_of(const RunIdentity& identity) {
  return {identity.sequence, identity.seed, identity.axis, identity.axis_value};
}

/// Whether the numbers of frames are those of different renderings: seeds of a recording begin some frames
/// later.
bool is_other_length(double frames, double others) {
  return std::abs(frames - others) > 30.0 && std::max(frames, others) > 1.25 * std::min(frames, others);
}

/// Removes the runs on older data under the name of newer data: another checksum for the same seed, or, as
/// the data of each seed differ, another number of frames.
/// @return the removed runs by sequence
std::map<std::string, std::size_t> remove_older_data(std::vector<StoredRun>& runs) {
  std::map<DataScope, std::pair<RunOrder, std::string>> newest;
  std::map<std::pair<std::string, double>, std::pair<RunOrder, double>>
      frames;  // by sequence, value of a sweep
  for (const StoredRun& run : runs) {
    const RunOrder order(run.started, run.id);
    auto& data = newest[data_scope_of(run.identity)];
    data = std::max(data, {order, run.identity.sequence_id});
    const std::optional<double> count = metric_value(run, metric_id::kFrames);
    auto& of_sequence = frames[{run.identity.sequence, run.identity.axis_value}];
    if (count && run.outcome == Outcome::kOk) of_sequence = std::max(of_sequence, {order, *count});
  }
  std::map<std::string, std::size_t> removed;
  std::erase_if(runs, [&](const StoredRun& run) {
    const RunIdentity& identity = run.identity;
    const double expected = frames.at({identity.sequence, identity.axis_value}).second;
    const double count = metric_value(run, metric_id::kFrames).value_or(expected);
    const bool is_older = newest.at(data_scope_of(identity)).second != identity.sequence_id ||
                          (run.outcome == Outcome::kOk && is_other_length(count, expected));
    removed[identity.sequence] += is_older ? 1 : 0;
    return is_older;
  });
  std::erase_if(removed, [](const auto& entry) { return entry.second == 0; });
  return removed;
}

/// Sentences about runs of other builds and of older configs, by name and number of runs.
std::vector<std::string> sentences_of(const std::map<std::string, std::size_t>& builds,
                                      const std::map<std::string, std::size_t>& variants,
                                      const std::map<std::string, std::size_t>& data) {
  const auto list = [](const std::map<std::string, std::size_t>& counts) {
    std::vector<std::string> names;
    names.reserve(counts.size());
    for (const auto& [name, count] : counts)
      names.push_back(fmt::format("{} ({} run{})", name, count, count == 1 ? "" : "s"));
    return listed(names);
  };
  std::vector<std::string> sentences;
  if (!builds.empty())
    sentences.push_back("Left out, other builds: " + list(builds) + "; select one with --build, or all.");
  if (!variants.empty())
    sentences.push_back("Left out, older configs of the same variant: " + list(variants) +
                        "; select the runs of one plan with --plan.");
  if (!data.empty())
    sentences.push_back("Left out, older data under the name of newer data: " + list(data) +
                        "; select the runs of one plan with --plan.");
  return sentences;
}

/// The group of a run; a new one at the end if there is none.
RunGroup& group_of(std::vector<RunGroup>& groups, const StoredRun& run, const RunOrigin& origin) {
  const RunGroup key{
      .build = run.identity.build, .machine = origin.host, .mode = mode_text(run.identity), .runs = {}};
  const auto found = std::find_if(groups.begin(), groups.end(), [&](const RunGroup& group) {
    return std::tie(group.build, group.machine, group.mode) == std::tie(key.build, key.machine, key.mode);
  });
  return found != groups.end() ? *found : groups.emplace_back(key);
}

}  // namespace

std::string planned_key(RunIdentity identity) {
  identity.build.clear();
  identity.config_hash.clear();
  return run_key(identity);
}

std::vector<StoredRun> runs_of_plan(const Store& store, const std::string& plan) {
  std::set<std::string> keys;
  std::set<std::string> planned;
  std::set<std::string> builds;  // of which all runs are known
  for (const StoredRun& run : store.plan_runs(plan)) {
    keys.insert(run.key);
    planned.insert(planned_key(run.identity));
    builds.insert(run.identity.build);
  }
  std::vector<StoredRun> runs = store.run_headers();
  std::erase_if(runs, [&](const StoredRun& run) {
    if (builds.contains(run.identity.build)) return !keys.contains(run.key);
    return !planned.contains(planned_key(run.identity));
  });
  return runs;
}

std::string newest_build(std::span<const StoredRun> runs) {
  std::vector<std::string> builds = builds_of(runs, kOwnSystem);
  if (builds.empty()) builds = builds_of(runs, "");
  return builds.empty() ? "" : builds.front();
}

std::map<std::string, std::string> newest_builds(std::span<const StoredRun> runs) {
  std::map<std::string, std::string> newest;
  for (const StoredRun& run : runs) {
    const std::string& system = run.identity.system;
    if (!newest.contains(system)) newest[system] = builds_of(runs, system).front();
  }
  return newest;
}

std::string build_named(std::span<const StoredRun> runs, const std::string& name, const std::string& place) {
  return chosen_build(builds_of(runs, ""), name, place);
}

RunSelection select_runs(const Store& store, std::vector<StoredRun> runs, const std::string& build) {
  const bool is_named = !build.empty() && build != kAllBuilds;
  const std::string chosen = is_named ? build_named(runs, build, "--build") : newest_build(runs);
  const RunOrigins origins = run_origins(store, runs);
  const NewestConfigs newest = newest_configs(runs, origins);
  std::map<std::string, std::size_t> other_builds;
  std::map<std::string, std::size_t> older_configs;
  RunSelection selection;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const RunIdentity& identity = runs[i].identity;
    const bool is_external = identity.system != kOwnSystem && !is_named;
    if (build != kAllBuilds && identity.build != chosen && !is_external) {
      ++other_builds[identity.build];
    } else if (!origins[i].config.empty() &&
               origins[i].config != newest.at(scope_of(identity, origins[i])).second) {
      ++older_configs[identity.variant];
    } else {
      group_of(selection.groups, runs[i], origins[i]).runs.push_back(std::move(runs[i]));
    }
  }
  std::map<std::string, std::size_t> older_data;
  for (RunGroup& group : selection.groups) {
    group.runs = store.with_details(std::move(group.runs));
    for (const auto& [sequence, count] : remove_older_data(group.runs)) older_data[sequence] += count;
  }
  selection.left_out = sentences_of(other_builds, older_configs, older_data);
  return selection;
}

}  // namespace stillpoint::bench
