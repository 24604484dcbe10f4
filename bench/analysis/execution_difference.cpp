// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/execution_difference.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "bench/model/metrics.h"

namespace stillpoint::bench {
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
