// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/charts/openloris_runs.h"

#include <algorithm>

#include "reports/tables/escaping.h"
#include "reports/tables/run_cells.h"

namespace stillpoint::report {
namespace {

constexpr const char* kScenes[] = {"home", "cafe", "corridor", "office", "market"};

bool is_scene(const std::string& sequence) {
  return std::any_of(std::begin(kScenes), std::end(kScenes),
                     [&](const char* scene) { return sequence.starts_with(scene); });
}

}  // namespace

eval::OpenlorisBenchmark openloris_of_runs(const bench::Store& store,
                                           std::span<const bench::StoredRun> runs) {
  eval::OpenlorisBenchmark benchmark;
  for (const bench::StoredRun& run : runs) {
    if (!is_scene(run.identity.sequence) || !run.identity.axis.empty()) continue;
    const Trajectory truth = store.truth(run);
    if (truth.poses.empty()) continue;
    const std::string scene = clean_line(run.identity.sequence);
    const int number = static_cast<int>(run.identity.seed);
    benchmark.gt_durations_s[scene][number] = seconds_between(truth.poses.front().t, truth.poses.back().t);
    const Trajectory path = store.trajectory(run);
    const eval::Similarity S_w_v = eval::align_openloris({{number, truth}}, {{number, path}});
    benchmark.systems[clean_line(system_label(run.identity))][scene].runs.emplace(
        number, eval::score_openloris_run(truth, path, S_w_v));
  }
  for (auto& [system, scenes] : benchmark.systems) {
    for (const auto& [scene, durations] : benchmark.gt_durations_s)
      scenes[scene].score = eval::score_openloris_scene(scenes[scene].runs, durations);
  }
  return benchmark;
}

}  // namespace stillpoint::report
