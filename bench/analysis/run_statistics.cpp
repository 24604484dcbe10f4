// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/run_statistics.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "bench/analysis/paired_runs.h"
#include "bench/model/metrics.h"
#include "bench/model/stored_run.h"
#include "core/base/error.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

using Point =
    std::tuple<std::string, std::string, std::string, double>;  // sequence, variant, axis, its value

/// A sweep over perturbations of the input gives replicates, not points of a curve.
Point point_of(const RunIdentity& identity) {
  if (identity.axis == kPerturbationKey) return {identity.sequence, identity.variant, "", 0.0};
  return {identity.sequence, identity.variant, identity.axis, identity.axis_value};
}

/// The value of a successful run; nullopt also if it is not finite.
std::optional<double> value_of(const StoredRun& run, const std::string& metric) {
  const std::optional<double> value = run.outcome == Outcome::kOk ? metric_value(run, metric) : std::nullopt;
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Values of the runs that are replicates: a deterministic metric counts once for runs with the same result.
std::vector<double> replicates(std::span<const StoredRun* const> runs, const std::string& metric) {
  const MetricDescriptor* gated = gated_metric(without_protocol(metric));
  const bool is_deterministic = gated != nullptr && gated->gate->repeatable;
  std::set<std::pair<std::string, std::string>> results;
  std::vector<double> values;
  for (const StoredRun* run : runs) {
    const std::optional<double> value = value_of(*run, metric);
    if (!value) continue;
    const bool is_new = results.insert({input_key(run->identity), fingerprint(*run)}).second;
    if (is_new || !is_deterministic) values.push_back(*value);
  }
  return values;
}

/// Summary of the values; the worst one is the smallest if larger is better.
std::optional<eval::Spread> spread_of(const std::vector<double>& values, const std::string& metric) {
  std::optional<eval::Spread> spread = eval::spread(values);
  const MetricDescriptor* descriptor = find_metric(without_protocol(metric));
  const bool is_reversed = descriptor != nullptr && descriptor->direction == MetricDirection::kLargerIsBetter;
  if (spread && is_reversed) spread->worst = *std::min_element(values.begin(), values.end());
  return spread;
}

/// Unit of pairing between variants.
using Subject =
    std::tuple<std::string, std::int64_t, std::string, double>;  // sequence, seed, axis, its value

/// Results of one variant on one subject.
struct SubjectRuns {
  std::size_t failed = 0;
  std::vector<double> values;
};
using SubjectTable = std::map<Subject, SubjectRuns>;

SubjectTable subjects_of(std::span<const StoredRun> runs, const std::string& variant,
                         const std::string& metric) {
  SubjectTable table;
  for (const StoredRun& run : runs) {
    const RunIdentity& identity = run.identity;
    if (identity.variant != variant) continue;
    SubjectRuns& subject = table[{identity.sequence, identity.seed, identity.axis, identity.axis_value}];
    if (const std::optional<double> value = value_of(run, metric)) {
      subject.values.push_back(*value);
    } else {
      ++subject.failed;
    }
  }
  return table;
}

AblationRow row_of(const std::string& variant, const std::string& sequence, const SubjectTable& base,
                   const SubjectTable& changed) {
  AblationRow row{.variant = variant, .sequence = sequence};
  std::vector<eval::Pair> pairs;
  for (const auto& [subject, runs] : base) {
    const auto found = changed.find(subject);
    if (found == changed.end() || (!sequence.empty() && std::get<0>(subject) != sequence)) continue;
    const std::optional<double> before = eval::percentile(runs.values, 0.5);
    const std::optional<double> after = eval::percentile(found->second.values, 0.5);
    if (before && after) pairs.push_back({*before, *after});
    row.newly_failed += before && !after ? 1 : 0;
  }
  row.difference = eval::paired_difference(pairs);
  const bool changes_from_zero = std::ranges::any_of(
      pairs, [](const eval::Pair& pair) { return pair.base == 0.0 && pair.changed != 0.0; });
  if (!changes_from_zero) row.change = eval::relative_change(pairs);
  return row;
}

std::vector<std::string> names_in_order(std::span<const StoredRun> runs, std::string RunIdentity::*name) {
  std::vector<std::string> names;
  for (const StoredRun& run : runs) {
    const std::string& value = run.identity.*name;
    if (std::find(names.begin(), names.end(), value) == names.end()) names.push_back(value);
  }
  return names;
}

std::vector<std::string> split_cells(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

std::optional<eval::Spread> metric_spread(std::span<const StoredRun* const> runs, const std::string& metric) {
  return spread_of(replicates(runs, metric), metric);
}

std::vector<RunSpread> run_spreads(std::span<const StoredRun> runs, const std::string& metric) {
  std::vector<RunSpread> rows;
  std::vector<std::vector<const StoredRun*>> members;
  std::map<Point, std::size_t> index;
  for (const StoredRun& run : runs) {
    const RunIdentity& identity = run.identity;
    const auto [entry, is_new] = index.insert({point_of(identity), rows.size()});
    if (is_new) {
      const auto& [sequence, variant, axis, axis_value] = entry->first;
      rows.push_back({.sequence = sequence, .variant = variant, .axis = axis, .axis_value = axis_value});
      members.emplace_back();
    }
    RunSpread& row = rows[entry->second];
    ++row.runs;
    row.failed += run.outcome == Outcome::kOk ? 0 : 1;
    members[entry->second].push_back(&run);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].spread = metric_spread(members[i], metric);
  return rows;
}

std::vector<AblationRow> ablation(std::span<const StoredRun> runs, const std::string& base,
                                  const std::string& metric) {
  const std::vector<std::string> variants = names_in_order(runs, &RunIdentity::variant);
  if (std::find(variants.begin(), variants.end(), base) == variants.end()) {
    throw InputError("--base", "there is no run of variant \"" + base +
                                   "\"; existing variants: " + fmt::format("{}", fmt::join(variants, ", ")));
  }
  const SubjectTable base_table = subjects_of(runs, base, metric);
  std::vector<AblationRow> rows;
  for (const std::string& variant : variants) {
    if (variant == base) continue;
    const SubjectTable table = subjects_of(runs, variant, metric);
    rows.push_back(row_of(variant, "", base_table, table));
    for (const std::string& sequence : names_in_order(runs, &RunIdentity::sequence)) {
      rows.push_back(row_of(variant, sequence, base_table, table));
    }
  }
  return rows;
}

std::string first_difference(const std::string& frames, const std::string& others) {
  std::istringstream first(frames);
  std::istringstream second(others);
  std::string line;
  std::string other;
  std::getline(first, line);
  std::getline(second, other);
  const std::vector<std::string> modules = split_cells(line);
  while (true) {
    const bool more = static_cast<bool>(std::getline(first, line));
    if (more != static_cast<bool>(std::getline(second, other))) return "the number of frames";
    if (!more) return "";
    if (line == other) continue;
    const std::vector<std::string> cells = split_cells(line);
    const std::vector<std::string> other_cells = split_cells(other);
    for (std::size_t i = 1; i < std::min({cells.size(), other_cells.size(), modules.size()}); ++i) {
      if (cells[i] != other_cells[i]) return "frame " + cells.front() + ", " + modules[i];
    }
  }
}

std::vector<StageDifference> stage_differences(const std::string& frames, const std::string& others) {
  std::istringstream first(frames);
  std::istringstream second(others);
  std::string line;
  std::string other;
  std::getline(first, line);
  std::getline(second, other);
  const std::vector<std::string> names = split_cells(line);
  std::vector<StageDifference> stages;
  for (std::size_t i = 1; i < names.size() && line == other; ++i) stages.push_back({names[i], std::nullopt});
  while (std::getline(first, line) && std::getline(second, other)) {
    const std::vector<std::string> a = split_cells(line);
    const std::vector<std::string> b = split_cells(other);
    for (std::size_t i = 0; i < stages.size() && i + 1 < std::min(a.size(), b.size()); ++i) {
      if (!stages[i].frame && a[i + 1] != b[i + 1]) stages[i].frame = std::stoll(a.front());
    }
  }
  return stages;
}

std::vector<RepetitionRow> repetition_report(const Store& store, std::span<const StoredRun> runs) {
  std::map<std::string, std::vector<const StoredRun*>> groups;
  for (const StoredRun& run : runs) {
    RunIdentity any = run.identity;
    any.repetition = 0;
    if (run.outcome == Outcome::kOk) groups[run_key(any)].push_back(&run);
  }
  std::vector<RepetitionRow> rows;
  for (const auto& [key, repeated] : groups) {
    if (repeated.size() < 2) continue;
    const RunIdentity& identity = repeated.front()->identity;
    RepetitionRow row{
        .label = fmt::format("{} {} seed {}", identity.sequence, identity.variant, identity.seed),
        .repetitions = repeated.size()};
    std::set<std::string> trajectories;
    for (const StoredRun* run : repeated) {
      if (const auto blob = run->blobs.find("trajectory"); blob != run->blobs.end())
        trajectories.insert(blob->second);
      if (run == repeated.front() || !row.first_difference.empty()) continue;
      row.first_difference =
          first_difference(store.attachment(*repeated.front(), "frames"), store.attachment(*run, "frames"));
    }
    row.distinct_trajectories = trajectories.size();
    rows.push_back(row);
  }
  return rows;
}

namespace {

std::string key_on_any_cores(const StoredRun& run) {
  RunIdentity identity = run.identity;
  identity.cores.clear();
  return run_key(identity);
}

/// Largest distances between poses of the same time.
void compare_poses(const Trajectory& a, const Trajectory& b, ExecutionDifference& row) {
  auto other = b.poses.begin();
  for (const StampedPose& pose : a.poses) {
    while (other != b.poses.end() && other->t < pose.t) ++other;
    if (other == b.poses.end()) return;
    if (other->t != pose.t) continue;
    row.largest_m = std::max(row.largest_m, (pose.T_w_f.p - other->T_w_f.p).norm());
    row.largest_rad = std::max(row.largest_rad, pose.T_w_f.q.angularDistance(other->T_w_f.q));
  }
}

ExecutionDifference difference(const Store& store, const StoredRun& run, const Store& other,
                               const StoredRun& counterpart) {
  const RunIdentity& identity = run.identity;
  ExecutionDifference row{
      .label = fmt::format("{} {} seed {}", identity.sequence, identity.variant, identity.seed)};
  const std::string frames = store.attachment(run, "frames");
  row.stages = stage_differences(frames, other.attachment(counterpart, "frames"));
  row.frames = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, std::ranges::count(frames, '\n') - 1));
  row.equal_trajectories = store.attachment(run, "trajectory") == other.attachment(counterpart, "trajectory");
  if (!row.equal_trajectories) compare_poses(store.trajectory(run), other.trajectory(counterpart), row);
  row.ate_m = metric_value(run, headline_metric().id);
  row.other_ate_m = metric_value(counterpart, headline_metric().id);
  return row;
}

}  // namespace

std::vector<ExecutionDifference> execution_differences(const Store& store, std::span<const StoredRun> runs,
                                                       const Store& other) {
  std::map<std::string, StoredRun> counterparts;
  for (StoredRun& run : other.runs()) {
    if (run.outcome == Outcome::kOk) counterparts.emplace(key_on_any_cores(run), std::move(run));
  }
  std::vector<ExecutionDifference> rows;
  for (const StoredRun& run : runs) {
    const auto found = counterparts.find(key_on_any_cores(run));
    if (run.outcome == Outcome::kOk && found != counterparts.end())
      rows.push_back(difference(store, run, other, found->second));
  }
  return rows;
}

}  // namespace stillpoint::bench
