// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/run_cost.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <queue>
#include <string>
#include <tuple>

#include "bench/model/metrics.h"

namespace stillpoint::bench {
namespace {

constexpr double kAssumedSecondsPerFrame =
    0.03;                                 // decoding and odometry of 848x480 images on one core of 2020
constexpr double kAssumedFrames = 900.0;  // of a recorded sequence that was never run
constexpr std::string_view kProcessTime = "process_wall_s";

using Durations = std::map<std::string, std::vector<double>>;

std::string sequence_key(const RunIdentity& run) {
  return run.system + '\n' + run.mode + '\n' + run.kind + '\n' + run.sequence_id;
}

std::string variant_key(const RunIdentity& run) {
  return sequence_key(run) + '\n' + run.variant + '\n' + run.axis + '\n' + std::to_string(run.axis_value);
}

/// Upper median; nullopt without values.
std::optional<double> median_duration(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

std::optional<double> median_duration(const Durations& durations, const std::string& key) {
  const auto found = durations.find(key);
  return found == durations.end() ? std::nullopt : median_duration(found->second);
}

/// Number of frames of a run that has no history.
double frames_of(const PlanSequence& sequence, const PlannedRun& run) {
  const double all =
      sequence.rendering ? sequence.rendering->seconds * sequence.rendering->frames_per_s : kAssumedFrames;
  return run.max_frames > 0 ? std::min(all, static_cast<double>(run.max_frames)) : all;
}

/// Durations of stored runs that processed their sequence.
class CostHistory {
 public:
  explicit CostHistory(std::span<const StoredRun> runs) {
    for (const StoredRun& run : runs) {
      const std::optional<double> seconds = metric_value(run, kProcessTime);
      if (!seconds || (run.outcome != Outcome::kOk && run.outcome != Outcome::kLost)) continue;
      by_variant_[variant_key(run.identity)].push_back(*seconds);
      by_sequence_[sequence_key(run.identity)].push_back(*seconds);
      const std::optional<double> frames = metric_value(run, metric_id::kFrames);
      if (frames && *frames > 0.0) per_frame_.push_back(*seconds / *frames);
    }
    seconds_per_frame_ = median_duration(per_frame_);
  }

  [[nodiscard]] RunCost cost_of(const PlanSequence& sequence, const PlannedRun& run) const {
    if (const auto same = median_duration(by_variant_, variant_key(run.identity)))
      return {*same, CostSource::kSameRun};
    if (const auto same = median_duration(by_sequence_, sequence_key(run.identity)))
      return {*same, CostSource::kSequence};
    return {frames_of(sequence, run) * seconds_per_frame_.value_or(kAssumedSecondsPerFrame),
            seconds_per_frame_ ? CostSource::kFrames : CostSource::kAssumed};
  }

 private:
  Durations by_variant_;
  Durations by_sequence_;
  std::vector<double> per_frame_;
  std::optional<double> seconds_per_frame_;
};

}  // namespace

std::vector<RunCost> expected_costs(const PlanMatrix& matrix, std::span<const StoredRun> history) {
  const CostHistory durations(history);
  std::vector<RunCost> costs;
  costs.reserve(matrix.runs.size());
  for (const PlannedRun& run : matrix.runs)
    costs.push_back(durations.cost_of(matrix.sequences[run.sequence], run));
  return costs;
}

double scheduled_seconds(std::span<const double> run_seconds, int workers) {
  std::priority_queue<double, std::vector<double>, std::greater<>> idle_at;
  for (int i = 0; i < std::max(1, workers); ++i) idle_at.push(0.0);
  double end = 0.0;
  for (const double seconds : run_seconds) {
    const double finished = idle_at.top() + seconds;
    idle_at.pop();
    idle_at.push(finished);
    end = std::max(end, finished);
  }
  return end;
}

std::vector<std::size_t> divide_evenly(std::span<const double> run_seconds, int tasks) {
  const std::size_t runs = run_seconds.size();
  const std::size_t parts = std::min(runs, static_cast<std::size_t>(std::max(1, tasks)));
  double remaining_s = 0.0;
  for (const double seconds : run_seconds) remaining_s += seconds;
  std::vector<std::size_t> bounds;
  std::size_t next = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    bounds.push_back(next);
    const std::size_t left = parts - part;  // including this one
    const double target_s = remaining_s / static_cast<double>(left);
    double sum_s = 0.0;
    // A run belongs to the part that contains its middle; each later part keeps at least one run.
    while (next < runs && runs - next >= left &&
           (sum_s == 0.0 || sum_s + 0.5 * run_seconds[next] <= target_s))
      sum_s += run_seconds[next++];
    remaining_s -= sum_s;
  }
  bounds.push_back(runs);
  return bounds;
}

std::vector<std::size_t> execution_order(const PlanMatrix& matrix, std::span<const StoredRun> history,
                                         int jobs) {
  std::vector<std::size_t> order;
  for (std::size_t run = 0; run < matrix.runs.size(); ++run) {
    if (matrix.sequences[matrix.runs[run].sequence].unavailable_reason.empty()) order.push_back(run);
  }
  if (matrix.plan.kind == RunKind::kTiming || jobs == 1) return order;
  const std::vector<RunCost> costs = expected_costs(matrix, history);
  std::vector<double> longest_s(matrix.sequences.size(), 0.0);
  for (const std::size_t run : order) {
    double& maximum = longest_s[matrix.runs[run].sequence];
    maximum = std::max(maximum, costs[run].seconds);
  }
  std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t run) {
    const std::size_t sequence = matrix.runs[run].sequence;
    return std::tuple(longest_s[sequence], longest_s.size() - sequence, costs[run].seconds);
  });
  return order;
}

}  // namespace stillpoint::bench
