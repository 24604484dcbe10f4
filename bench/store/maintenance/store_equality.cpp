// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/maintenance/store_equality.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/metrics.h"
#include "bench/store/store.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// Attachments that contain times, or messages with paths.
constexpr std::array<std::string_view, 4> kVolatileAttachments = {"result", "timings", "stacks", "log"};
/// Members of the manifest that describe the machine or the time.
constexpr std::array<const char*, 2> kVolatileMembers = {"host", "started"};

/// Whether a metric measures the machine. Metrics of external systems are in no list; they are results.
bool depends_on_machine(const Metric& metric) {
  const MetricDescriptor* descriptor = find_metric(without_protocol(metric.name));
  if (descriptor == nullptr) return false;
  return descriptor->source == MetricSource::kProcess || descriptor->source == MetricSource::kMachine ||
         descriptor->id == metric_id::kWallTime;
}

std::string manifest_content(const std::string& manifest) {
  nlohmann::json json = nlohmann::json::parse(manifest, nullptr, false);
  if (!json.is_object()) return manifest;
  for (const char* member : kVolatileMembers) json.erase(member);
  return json.dump();
}

/// What is compared of a run: text by name. Numbers are compared bit by bit.
std::map<std::string, std::string> content_of(const Store& store, const StoredRun& run) {
  std::map<std::string, std::string> content = {{"outcome", outcome_name(run.outcome)},
                                                {"detail", run.detail},
                                                {"manifest", manifest_content(store.manifest(run))}};
  for (const Metric& metric : run.metrics) {
    if (depends_on_machine(metric)) continue;
    content["metric " + metric.name + " (" + metric.protocol + ")"] =
        fmt::format("{} {}", metric.value, metric.unit);
  }
  for (const ModuleCost& cost : run.costs) content["module " + cost.module] = "timed per " + cost.per;
  for (const auto& [kind, blob] : run.blobs) {
    const bool is_volatile =
        std::ranges::find(kVolatileAttachments, std::string_view(kind)) != kVolatileAttachments.end();
    if (!is_volatile) content["attachment " + kind] = blob;
  }
  return content;
}

std::string quoted(const std::optional<std::string>& text) {
  constexpr std::size_t kShownLength = 60;
  if (!text) return "missing";
  return text->size() <= kShownLength ? "\"" + *text + "\"" : fmt::format("{} characters", text->size());
}

/// Adds a line for each name whose text is not the same in both maps.
void append_differences(std::vector<std::string>& lines, const std::string& subject,
                        const std::map<std::string, std::string>& first,
                        const std::map<std::string, std::string>& second) {
  std::set<std::string> names;
  for (const auto& [name, text] : first) names.insert(name);
  for (const auto& [name, text] : second) names.insert(name);
  for (const std::string& name : names) {
    const auto text_of = [&](const std::map<std::string, std::string>& content) {
      const auto found = content.find(name);
      return found == content.end() ? std::nullopt : std::optional(found->second);
    };
    if (text_of(first) == text_of(second)) continue;
    lines.push_back(
        fmt::format("{}: {}: {} and {}", subject, name, quoted(text_of(first)), quoted(text_of(second))));
  }
}

std::string label_of(const StoredRun& run) {
  return fmt::format("run {} ({} {})", run.key, run.identity.sequence, run.identity.variant);
}

std::map<std::string, std::string> plans_of(const Store& store) {
  std::map<std::string, std::string> plans;
  for (const StoredPlan& plan : store.plans()) {
    std::string& text = plans["plan " + plan.name];
    text = plan.title + "\n" + plan.text;
    for (const std::string& key : plan.run_keys) text += "\n" + key;
  }
  return plans;
}

}  // namespace

std::vector<std::string> store_differences(const fs::path& first, const fs::path& second) {
  const Store store_a(first);
  const Store store_b(second);
  std::map<std::string, StoredRun> remaining;
  for (StoredRun& run : store_b.runs()) remaining[run.key] = std::move(run);
  std::vector<std::string> lines;
  for (const StoredRun& run : store_a.runs()) {
    const auto other = remaining.find(run.key);
    if (other == remaining.end()) {
      lines.push_back(label_of(run) + ": only in " + first.string());
      continue;
    }
    append_differences(lines, label_of(run), content_of(store_a, run), content_of(store_b, other->second));
    remaining.erase(other);
  }
  for (const auto& [key, run] : remaining) lines.push_back(label_of(run) + ": only in " + second.string());
  append_differences(lines, "store", plans_of(store_a), plans_of(store_b));
  return lines;
}

}  // namespace stillpoint::bench
