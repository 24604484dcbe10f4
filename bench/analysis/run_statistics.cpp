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
#include "bench/model/run_notes.h"
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

/// Whether equal trajectories imply equal values.
bool is_deterministic(const std::string& metric) {
  const MetricDescriptor* known = find_metric(without_protocol(metric));
  if (known == nullptr) return false;
  if (known->gate) return known->gate->repeatable;
  return known->source == MetricSource::kTrajectory || known->source == MetricSource::kHonesty ||
         known->source == MetricSource::kProtocol;
}

/// Values of the runs that are replicates: a deterministic metric counts once for runs with the same result.
std::vector<double> replicates(std::span<const StoredRun* const> runs, const std::string& metric) {
  const bool counts_once = is_deterministic(metric);
  std::set<std::string> results;
  std::vector<double> values;
  for (const StoredRun* run : runs) {
    const std::optional<double> value = value_of(*run, metric);
    if (!value) continue;
    const std::string result = fingerprint(*run);
    if (results.insert(result).second || result.empty() || !counts_once) values.push_back(*value);
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
  std::size_t succeeded = 0;
  std::vector<double> values;
  std::vector<double> coverages;
  std::set<std::string> results;  ///< fingerprints
};
using SubjectTable = std::map<Subject, SubjectRuns>;

SubjectTable subjects_of(std::span<const StoredRun> runs, const std::string& variant,
                         const std::string& metric) {
  SubjectTable table;
  for (const StoredRun& run : runs) {
    const RunIdentity& identity = run.identity;
    if (identity.variant != variant) continue;
    SubjectRuns& subject = table[{identity.sequence, identity.seed, identity.axis, identity.axis_value}];
    subject.succeeded += run.outcome == Outcome::kOk ? 1 : 0;
    if (const std::optional<double> value = value_of(run, metric)) {
      subject.values.push_back(*value);
      subject.results.insert(fingerprint(run));
      const std::optional<double> coverage = value_of(run, std::string(metric_id::kCoverage));
      if (coverage) subject.coverages.push_back(*coverage);
    }
  }
  return table;
}

double gap(const eval::Pair& coverages) { return std::abs(coverages.base - coverages.changed); }

eval::Pair wider_gap(const eval::Pair& a, const eval::Pair& b) { return gap(b) > gap(a) ? b : a; }

/// Of metrics that are small if most of the track is lost.
std::string coverage_doubt(const eval::Pair& coverages, const std::string& metric) {
  const MetricDescriptor* known = find_metric(without_protocol(metric));
  const bool is_error = known != nullptr && known->source == MetricSource::kTrajectory &&
                        known->direction == MetricDirection::kSmallerIsBetter;
  if (!is_error || gap(coverages) <= kMaxCoverageGap) return "";
  return fmt::format("coverage {:.2f}, base {:.2f}: not comparable", coverages.changed, coverages.base);
}

/// Of an RPE of few pairs of poses, or a doubtful ground truth or trajectory, in a run of either variant; of
/// several sequences the latter are named only.
std::string run_doubt(std::span<const StoredRun> runs, const std::string& base, const AblationRow& row,
                      const std::string& metric) {
  std::vector<const StoredRun*> compared;
  std::vector<std::string> doubtful;
  for (const StoredRun& run : runs) {
    const RunIdentity& identity = run.identity;
    const bool is_of_row = row.sequence.empty() || identity.sequence == row.sequence;
    if (!is_of_row || (identity.variant != base && identity.variant != row.variant)) continue;
    compared.push_back(&run);
    if (!doubtful_error_note(std::span(&compared.back(), 1), metric).empty() &&
        std::ranges::find(doubtful, identity.sequence) == doubtful.end())
      doubtful.push_back(identity.sequence);
  }
  std::string doubt;
  if (!row.sequence.empty()) {
    doubt = doubtful_error_note(compared, metric);
  } else if (!doubtful.empty()) {
    doubt = fmt::format("doubtful errors on {}", fmt::join(doubtful, ", "));
  }
  return joined_notes({few_rpe_pairs_note(compared, metric), doubt});
}

void add_doubt(AblationRow& row, const std::string& doubt) {
  if (!doubt.empty()) row.doubt += (row.doubt.empty() ? "" : "; ") + doubt;
}

/// Pairs of one sequence.
class SequencePairs {
 public:
  /// @param counts_once whether equal results count once
  void add(const SubjectRuns& base, const SubjectRuns& changed, bool counts_once) {
    const std::optional<double> before = eval::percentile(base.values, 0.5);
    const std::optional<double> after = eval::percentile(changed.values, 0.5);
    newly_failed += base.succeeded > 0 && changed.succeeded == 0 ? 1 : 0;
    newly_without_value += before && !after && changed.succeeded > 0 ? 1 : 0;
    if (!before || !after) return;
    const bool is_new = base_results_.insert(base.results).second || base.results.contains("");
    const bool is_new_change =
        changed_results_.insert(changed.results).second || changed.results.contains("");
    if (counts_once && !(is_new && is_new_change)) {
      ++copies;
    } else {
      pairs.push_back({*before, *after});
      const std::optional<double> covered_before = eval::percentile(base.coverages, 0.5);
      const std::optional<double> covered_after = eval::percentile(changed.coverages, 0.5);
      if (covered_before && covered_after)
        coverages = wider_gap(coverages, {*covered_before, *covered_after});
    }
  }

  std::vector<eval::Pair> pairs{};
  eval::Pair coverages;  ///< of the pair in which they differ most
  std::size_t newly_failed = 0;
  std::size_t newly_without_value = 0;
  std::size_t copies = 0;

 private:
  std::set<std::set<std::string>> base_results_;
  std::set<std::set<std::string>> changed_results_;
};

bool changes_from_zero(const std::vector<eval::Pair>& pairs) {
  return std::ranges::any_of(pairs,
                             [](const eval::Pair& pair) { return pair.base == 0.0 && pair.changed != 0.0; });
}

/// The differences and ratios of one or several sequences, as in `AblationRow`.
void add_estimates(AblationRow& row, const std::vector<std::vector<eval::Pair>>& sequences) {
  std::vector<eval::Pair> differences;
  std::vector<eval::Pair> ratios;
  bool has_ratios = true;
  for (const std::vector<eval::Pair>& pairs : sequences) {
    if (sequences.size() == 1) {
      differences = ratios = pairs;
    } else {
      std::vector<double> of_sequence;
      of_sequence.reserve(pairs.size());
      for (const eval::Pair& pair : pairs) of_sequence.push_back(pair.changed - pair.base);
      differences.push_back({0.0, *eval::percentile(of_sequence, 0.5)});
      // With few values per sequence, the pseudomedian is the estimate of the row of the sequence, too.
      const std::optional<eval::RelativeChange> change = eval::relative_change(pairs);
      if (change) ratios.push_back({1.0, 1.0 + change->median});
    }
    has_ratios = has_ratios && !changes_from_zero(pairs);
  }
  row.difference = eval::paired_difference(differences);
  if (has_ratios) row.change = eval::relative_change(ratios);
}

/// Why a row has no pairs of runs, whatever their outcome.
/// @param sequence empty: all
std::string unpaired_doubt(const std::string& sequence, const SubjectTable& base,
                           const SubjectTable& changed) {
  const auto has_runs = [&](const SubjectTable& table) {
    return std::ranges::any_of(
        table, [&](const auto& entry) { return sequence.empty() || std::get<0>(entry.first) == sequence; });
  };
  if (!has_runs(base)) return "no run of the base";
  if (!has_runs(changed)) return "no run of the variant";
  return sequence.empty() ? "no sequence and seed in common with the base"
                          : "no seed in common with the base";
}

/// @param names variant and sequence of the row
AblationRow row_of(const AblationRow& names, const SubjectTable& base, const SubjectTable& changed,
                   const std::string& metric) {
  AblationRow row = names;
  const bool counts_once = is_deterministic(metric);
  eval::Pair coverages;
  std::map<std::string, SequencePairs> sequences;
  for (const auto& [subject, runs] : base) {
    const std::string& sequence = std::get<0>(subject);
    const auto found = changed.find(subject);
    if (found != changed.end() && (names.sequence.empty() || sequence == names.sequence))
      sequences[sequence].add(runs, found->second, counts_once);
  }
  std::vector<std::vector<eval::Pair>> pairs;
  for (const auto& [sequence, of_sequence] : sequences) {
    row.newly_failed += of_sequence.newly_failed;
    row.newly_without_value += of_sequence.newly_without_value;
    row.copies += of_sequence.copies;
    coverages = wider_gap(coverages, of_sequence.coverages);
    if (!of_sequence.pairs.empty()) pairs.push_back(of_sequence.pairs);
  }
  row.sequences = pairs.size();
  add_estimates(row, pairs);
  row.doubt =
      sequences.empty() ? unpaired_doubt(names.sequence, base, changed) : coverage_doubt(coverages, metric);
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
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].spread = metric_spread(members[i], metric);
    const auto with_value = static_cast<std::size_t>(std::ranges::count_if(
        members[i], [&](const StoredRun* run) { return value_of(*run, metric).has_value(); }));
    rows[i].without_value = rows[i].runs - rows[i].failed - with_value;
    rows[i].doubt = joined_notes({few_rpe_pairs_note(members[i], metric),
                                  doubtful_error_note(members[i], metric), scatter_note(members[i], metric)});
    rows[i].copies = with_value - (rows[i].spread ? rows[i].spread->count : 0);
  }
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
  std::vector<std::string> sequences = names_in_order(runs, &RunIdentity::sequence);
  sequences.insert(sequences.begin(), "");  // all
  std::vector<AblationRow> rows;
  for (const std::string& variant : variants) {
    if (variant == base) continue;
    const SubjectTable table = subjects_of(runs, variant, metric);
    for (const std::string& sequence : sequences) {
      rows.push_back(row_of({.variant = variant, .sequence = sequence}, base_table, table, metric));
      add_doubt(rows.back(), run_doubt(runs, base, rows.back(), metric));
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

namespace {

std::string label_of(const RunIdentity& identity) {
  return fmt::format(
      "{} {} seed {}{}", identity.sequence, identity.variant, identity.seed,
      identity.axis.empty() ? "" : fmt::format(" {} = {}", identity.axis, identity.axis_value));
}

}  // namespace

std::vector<RepetitionRow> repetition_report(const Store& store, std::span<const StoredRun> runs) {
  std::map<std::string, std::vector<const StoredRun*>> groups;
  for (const StoredRun& run : runs) {
    RunIdentity any = run.identity;
    any.repetition = 0;
    groups[run_key(any)].push_back(&run);
  }
  std::vector<RepetitionRow> rows;
  for (const auto& [key, repeated] : groups) {
    if (repeated.size() < 2) continue;
    const RunIdentity& identity = repeated.front()->identity;
    RepetitionRow row{.label = label_of(identity), .identity = identity, .repetitions = repeated.size()};
    std::set<std::string> trajectories;
    const StoredRun* first = nullptr;
    for (const StoredRun* run : repeated) {
      if (run->outcome != Outcome::kOk) {
        ++row.failed;
        continue;
      }
      const auto blob = run->blobs.find("trajectory");
      trajectories.insert(blob == run->blobs.end() ? "" : blob->second);
      if (first == nullptr) first = run;
      if (run == first || !row.first_difference.empty()) continue;
      row.first_difference =
          first_difference(store.attachment(*first, "frames"), store.attachment(*run, "frames"));
    }
    if (trajectories == std::set<std::string>{""}) trajectories.clear();  // none was recorded
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
  ExecutionDifference row{.label = label_of(identity), .identity = identity};
  if (run.outcome != Outcome::kOk || counterpart.outcome != Outcome::kOk) {
    row.failure = outcome_name(run.outcome) + ", other " + outcome_name(counterpart.outcome);
    return row;
  }
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
    std::string key = key_on_any_cores(run);
    counterparts.emplace(std::move(key), std::move(run));
  }
  std::vector<ExecutionDifference> rows;
  for (const StoredRun& run : runs) {
    const auto found = counterparts.find(key_on_any_cores(run));
    if (found != counterparts.end()) rows.push_back(difference(store, run, other, found->second));
  }
  return rows;
}

}  // namespace stillpoint::bench
