// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/maintenance/maintenance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/metrics.h"
#include "bench/store/schema.h"
#include "bench/store/store.h"
#include "core/base/error.h"

namespace stillpoint::bench {

bool add_run(StoreWriter& writer, const RunIdentity& identity, const RunOutcome& outcome) {
  if (writer.acquire(identity) != RunLease::kGranted) return false;
  writer.finish(identity, outcome);
  return true;
}

namespace {

namespace fs = std::filesystem;

/// Runs a check of the database. @return one text per fault
std::vector<std::string> faults_of(Statement check, const std::string& what) {
  std::vector<std::string> faults;
  while (check.step()) {
    if (check.text(0) != "ok") faults.push_back(what + ": " + check.text(0));
  }
  return faults;
}

/// One text per metric with an infinite or impossible value.
std::vector<std::string> faulty_metrics(const Database& database) {
  std::vector<std::string> faults;
  Statement rows = database.prepare(
      "SELECT run.key, name, value FROM metric JOIN run ON run.id = metric.run "
      "WHERE value < 0 OR value > 1");
  while (rows.step()) {
    const Metric metric{.name = rows.text(1), .value = rows.real(2)};
    const std::string_view fault = std::isinf(metric.value) ? "infinite" : impossibility(metric);
    if (!fault.empty())
      faults.push_back(fmt::format("run {}: metric \"{}\" is {}", rows.text(0), metric.name, fault));
  }
  return faults;
}

std::set<std::string> referenced_files(const Database& database) {
  std::set<std::string> names;
  Statement rows = database.prepare("SELECT DISTINCT blob FROM attachment");
  while (rows.step()) names.insert(rows.text(0));
  return names;
}

/// One text per referenced file that cannot be read.
std::vector<std::string> damaged_files(const Database& database, const BlobFiles& blobs) {
  std::vector<std::string> faults;
  for (const std::string& name : referenced_files(database)) {
    try {
      static_cast<void>(blobs.get(name));
    } catch (const InputError& error) {
      faults.emplace_back(error.what());
    }
  }
  return faults;
}

RunOutcome outcome_from(const Store& store, const StoredRun& run) {
  RunOutcome outcome{.outcome = run.outcome,
                     .detail = run.detail,
                     .metrics = run.metrics,
                     .costs = run.costs,
                     .attachments = {},
                     .manifest = store.manifest(run),
                     .started = run.started,
                     .ended = run.ended};
  for (const auto& [kind, blob] : run.blobs) outcome.attachments[kind] = store.attachment(run, kind);
  return outcome;
}

}  // namespace

std::vector<std::string> verify_store(const fs::path& file) {
  const Database database(file, DatabaseAccess::kRead);
  require_readable_schema(database);
  std::vector<std::string> faults;
  // A damaged page can end each check; the others are still executed.
  const auto add = [&](const auto& check) {
    try {
      for (std::string& fault : check()) faults.push_back(std::move(fault));
    } catch (const InputError& error) {
      faults.emplace_back(error.what());
    }
  };
  add([&] { return faults_of(database.prepare("PRAGMA integrity_check"), "database"); });
  add([&] {
    return faults_of(database.prepare("PRAGMA foreign_key_check"), "row with a missing reference");
  });
  add([&] { return faulty_metrics(database); });
  add([&] { return damaged_files(database, BlobFiles(files_folder(file) / "blobs")); });
  return faults;
}

GarbageReport collect_garbage(const fs::path& file) {
  static_cast<void>(Store(file));   // a writer would create a store, also in an empty file
  const StoreWriter cleared(file);  // removes the folders of dead workers
  const Database database(file, DatabaseAccess::kWrite);
  const BlobFiles blobs(files_folder(file) / "blobs");
  Transaction transaction(database);  // blocks writers, which could reference an unused file
  GarbageReport report;
  const std::set<std::string> referenced = referenced_files(database);
  for (const std::string& name : blobs.names()) {
    if (referenced.contains(name)) continue;
    ++report.files;
    report.bytes += static_cast<std::int64_t>(fs::file_size(blobs.file(name)));
    blobs.remove(name);
  }
  constexpr const char* kUnused =
      "FROM manifest WHERE hash NOT IN (SELECT manifest FROM run WHERE manifest NOT NULL)";
  report.manifests = static_cast<std::size_t>(database.integer(std::string("SELECT count(*) ") + kUnused));
  database.execute(std::string("DELETE ") + kUnused);
  transaction.commit();
  return report;
}

namespace {

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
  if (json.contains("system")) json["system"].erase("folder");  // of its description on the machine
  return json.dump();
}

/// What does not depend on the machine: text by name. Numbers are compared bit by bit.
std::map<std::string, std::string> results_of(Outcome outcome, const std::vector<Metric>& metrics) {
  std::map<std::string, std::string> results = {{"outcome", outcome_name(outcome)}};
  for (const Metric& metric : metrics) {
    if (depends_on_machine(metric)) continue;
    results["metric " + metric.name + " (" + metric.protocol + ")"] =
        fmt::format("{} {}", metric.value, metric.unit);
  }
  return results;
}

/// What is compared of a run: text by name.
std::map<std::string, std::string> content_of(const Store& store, const StoredRun& run) {
  std::map<std::string, std::string> content = results_of(run.outcome, run.metrics);
  content["detail"] = run.detail;
  content["manifest"] = manifest_content(store.manifest(run));
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

std::string label_of(const RunIdentity& identity) {
  return fmt::format("run {} ({} {})", run_key(identity), identity.sequence, identity.variant);
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

RunMerger::RunMerger(const fs::path& into) : writer_(into), files_(files_folder(into) / "blobs") {
  for (const StoredRun& run : Store(into).runs())
    present_[run.key] = {results_of(run.outcome, run.metrics), run.blobs};
}

void RunMerger::restore_files(const PresentRun& run, const RunOutcome& outcome) {
  for (const auto& [kind, content] : outcome.attachments) {
    const auto known = run.files.find(kind);
    if (known == run.files.end() || known->second != blob_name(content) || files_.is_readable(known->second))
      continue;
    static_cast<void>(files_.put(content));
    ++report_.restored;
  }
}

void RunMerger::add(const RunIdentity& identity, const RunOutcome& outcome) {
  const bool is_added = add_run(writer_, identity, outcome);
  ++(is_added ? report_.added : report_.present);
  const Results results = results_of(outcome.outcome, outcome.metrics);
  const auto [known, is_new] = present_.try_emplace(run_key(identity), PresentRun{results, {}});
  if (is_new || is_added) return;
  restore_files(known->second, outcome);
  if (known->second.results != results) report_.contradicting.push_back(label_of(identity));
}

MergeReport merge_stores(const fs::path& from, const fs::path& into) {
  if (fs::exists(into) && fs::equivalent(from, into)) throw InputError(into.string(), "is the same store");
  const Store source(from);
  RunMerger merger(into);
  for (const StoredRun& run : source.runs()) merger.add(run.identity, outcome_from(source, run));
  for (const StoredPlan& plan : source.plans()) merger.writer().record_plan(plan);
  write_acceptances(into, source.acceptances());
  return merger.report();
}

std::vector<std::string> store_differences(const fs::path& first, const fs::path& second) {
  const Store store_a(first);
  const Store store_b(second);
  std::map<std::string, StoredRun> remaining;
  for (StoredRun& run : store_b.runs()) remaining[run.key] = std::move(run);
  std::vector<std::string> lines;
  for (const StoredRun& run : store_a.runs()) {
    const auto other = remaining.find(run.key);
    if (other == remaining.end()) {
      lines.push_back(label_of(run.identity) + ": only in " + first.string());
      continue;
    }
    append_differences(lines, label_of(run.identity), content_of(store_a, run),
                       content_of(store_b, other->second));
    remaining.erase(other);
  }
  for (const auto& [key, run] : remaining)
    lines.push_back(label_of(run.identity) + ": only in " + second.string());
  append_differences(lines, "store", plans_of(store_a), plans_of(store_b));
  return lines;
}

}  // namespace stillpoint::bench
