// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint stats imperfections`.
#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/stats/stats_actions.h"
#include "bench/model/metrics.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

constexpr double kMinCoverage = 0.5;  // the ATE of fewer frames is not comparable

std::string fault_of(const StoredRun& run) {
  const std::size_t end = run.identity.sequence.find(kFaultSeparator);
  return end == std::string::npos ? "" : run.identity.sequence.substr(end + kFaultSeparator.size());
}

/// With the sweep point: errors at different ones have no common mean.
std::string variant_of(const StoredRun& run) {
  const RunIdentity& identity = run.identity;
  return identity.axis.empty()
             ? identity.variant
             : fmt::format("{} ({} = {})", identity.variant, identity.axis, identity.axis_value);
}

/// The ATE; nullopt if the run is lost.
std::optional<double> ate_if_located(const StoredRun& run) {
  const double coverage = metric_value(run, metric_id::kCoverage).value_or(1.0);
  if (run.outcome != Outcome::kOk || coverage < kMinCoverage) return std::nullopt;
  return metric_value(run, metric_id::kAte);
}

/// `ate_if_located` of the run with the same sequence, seed, repetition, variant and sweep point, but without
/// a fault.
std::optional<double> undisturbed_ate(const RunGroup& group, const StoredRun& run) {
  const std::string sequence = run.identity.sequence.substr(0, run.identity.sequence.find(kFaultSeparator));
  const auto found = std::ranges::find_if(group.runs, [&](const StoredRun& other) {
    return other.identity.sequence == sequence && variant_of(other) == variant_of(run) &&
           other.identity.seed == run.identity.seed && other.identity.repetition == run.identity.repetition;
  });
  return found == group.runs.end() ? std::nullopt : ate_if_located(*found);
}

class Mean {
 public:
  void add(double value) { sum_ += value, ++count_; }
  [[nodiscard]] std::optional<double> value() const {
    return count_ > 0 ? std::optional(sum_ / count_) : std::nullopt;
  }

 private:
  double sum_ = 0.0;
  int count_ = 0;
};

/// The mean of the logarithms of errors; there is none if one of them is 0.
class LogMean {
 public:
  void add(double value) {
    has_zero_ = has_zero_ || value <= 0.0;
    mean_.add(std::log(value));
  }
  [[nodiscard]] std::optional<double> value() const { return has_zero_ ? std::nullopt : mean_.value(); }

 private:
  Mean mean_;
  bool has_zero_ = false;
};

/// Runs of one variant with one fault, or with all.
struct FaultMeans {
  int runs = 0, lost = 0;
  LogMean log_ate, log_ratio;
  Mean false_confidence;
  double worst_ate_m = 0.0;

  void add(const RunGroup& group, const StoredRun& run) {
    ++runs;
    if (const auto wrong = metric_value(run, metric_id::kFalseConfidence)) false_confidence.add(*wrong);
    const std::optional<double> ate_m = ate_if_located(run);
    if (!ate_m) {
      ++lost;
      return;
    }
    log_ate.add(*ate_m);
    worst_ate_m = std::max(worst_ate_m, *ate_m);
    if (const auto undisturbed_m = undisturbed_ate(group, run))
      log_ratio.add(*undisturbed_m > 0.0 ? *ate_m / *undisturbed_m : 0.0);
  }

  [[nodiscard]] std::vector<std::string> cells(const std::string& fault, const std::string& variant) const {
    const auto exp_cell = [](const std::optional<double>& log) {
      return log ? number_cell(std::exp(*log)) : "n/a";
    };
    const std::optional<double> wrong = false_confidence.value();
    return {fault,
            variant,
            fmt::format("{}", runs),
            fmt::format("{}", lost),
            exp_cell(log_ate.value()),
            exp_cell(log_ratio.value()),
            lost < runs ? number_cell(worst_ate_m) : "n/a",
            wrong ? fmt::format("{:.2f} %", 100.0 * *wrong) : "n/a"};
  }

  [[nodiscard]] report::DataRow values(const std::string& fault, const std::string& variant) const {
    using report::data_value;
    const auto exp_value = [](const std::optional<double>& log) {
      return log ? report::DataValue(std::exp(*log)) : report::DataValue();
    };
    return {fault,
            variant,
            static_cast<std::int64_t>(runs),
            static_cast<std::int64_t>(lost),
            exp_value(log_ate.value()),
            exp_value(log_ratio.value()),
            lost < runs ? report::DataValue(worst_ate_m) : report::DataValue(),
            data_value(false_confidence.value())};
  }
};

/// In the order of the first run of each fault, the undisturbed runs first.
GroupRows mean_rows(const RunGroup& group) {
  std::vector<std::string> faults;
  std::map<std::pair<std::string, std::string>, FaultMeans> means;  // by fault and variant
  for (const StoredRun& run : group.runs) {
    const std::string fault = fault_of(run);
    if (std::ranges::find(faults, fault) == faults.end()) faults.push_back(fault);
    means[{fault, variant_of(run)}].add(group, run);
    if (!fault.empty()) means[{"(all)", variant_of(run)}].add(group, run);
  }
  if (faults.empty() || (faults.size() == 1 && faults.front().empty()))
    return {.group = &group, .rows = {}, .data = {}};
  std::stable_partition(faults.begin(), faults.end(), [](const std::string& fault) { return fault.empty(); });
  faults.emplace_back("(all)");
  GroupRows rows{.group = &group, .rows = {}, .data = {}};
  for (const std::string& fault : faults) {
    const std::string name = fault.empty() ? "(none)" : fault;
    for (const auto& [key, mean] : means) {
      if (key.first != fault) continue;
      rows.rows.push_back(mean.cells(name, key.second));
      rows.data.push_back(mean.values(name, key.second));
    }
  }
  return rows;
}

/// Names the runs that have no logarithm of the ATE.
std::vector<std::string> zero_notes(const RunSelection& selection) {
  std::vector<std::string> notes;
  for (const RunGroup& group : selection.groups) {
    for (const StoredRun& run : group.runs) {
      if (ate_if_located(run) != 0.0) continue;
      notes.push_back(
          fmt::format("{}{}, {}: an ATE of 0, as of a copy of the ground truth, has no geometric "
                      "mean: n/a.",
                      group_prefix(selection, group), run.identity.sequence, run.identity.variant));
    }
  }
  return notes;
}

}  // namespace

int stats_imperfections(const StatsArguments& arguments) {
  const Store store(arguments.store);
  const StatsArguments chosen = with_default_plan(store, arguments, "imperfections");
  const RunSelection selection = chosen_runs(store, chosen);
  std::vector<GroupRows> groups;
  for (const RunGroup& group : selection.groups) {
    GroupRows rows = mean_rows(group);
    if (!rows.rows.empty()) groups.push_back(std::move(rows));
  }
  if (groups.empty())
    throw InputError(chosen.store, "contains no run with a fault; add \"faults\" to the plan");
  print_stats(
      {.header = {"fault", "variant", "runs", "lost", "ATE m", "ratio", "worst ATE m", "false confidence"},
       .kind = "stats_imperfections",
       .columns = {"fault", "variant", "runs", "lost", "ate_rmse_m", "ate_ratio", "worst_ate_rmse_m",
                   "false_confidence"},
       .groups = std::move(groups),
       .notes =
           with_left_out(with_doubts({"ATE: geometric mean over the runs that are not lost; ratio: "
                                      "geometric mean of the ATE relative to the same sequence without a "
                                      "fault."},
                                     zero_notes(selection)),
                         selection)},
      chosen);
  return kExitOk;
}

}  // namespace stillpoint::bench
