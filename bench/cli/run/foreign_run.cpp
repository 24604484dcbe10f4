// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/foreign_run.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "bench/cli/run/sequence_playback.h"
#include "bench/store/find_run.h"
#include "bench/systems/external_run.h"
#include "core/base/error.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::bench {
namespace {

/// @throws InputError unless the run is one of the recording as it is played
void require_sequence(const StoredRun& run, const RunConditions& conditions) {
  std::string expected = sequence_identity(conditions.info, conditions.rig_file);
  for (const datasets::SensorFault& fault : conditions.faults) expected += "-" + fault_text(fault);
  if (run.identity.sequence_id == expected) return;
  throw InputError(
      fmt::format("run {}", run.key),
      fmt::format("is a run of {} (identity {}), here it is {}: other files, calibration, number "
                  "of frames or faults; if they are the same, pass the trajectory.tum that "
                  "`stillpoint store extract` writes",
                  run.identity.sequence, run.identity.sequence_id, expected));
}

Trajectory trajectory_of(const FinishedRunSource& source, const RunConditions& conditions) {
  if (source.store.empty()) return eval::read_trajectory({.path = source.run}).trajectory;
  const Store store(source.store);
  const StoredRun run = find_run(store, source.run);
  require_sequence(run, conditions);
  const std::string text = store.attachment(run, "trajectory");
  if (text.empty()) throw InputError(fmt::format("run {}", run.key), "has no trajectory; use another run");
  return eval::parse_tum(text, fmt::format("run {}", run.key)).trajectory;
}

}  // namespace

bool is_foreign(const FinishedRunSource& source) {
  if (source.store.empty()) return std::filesystem::is_regular_file(source.run);
  return find_run(Store(source.store), source.run).identity.system != RunIdentity{}.system;
}

OdometryRun read_foreign_run(const FinishedRunSource& source, const RunConditions& conditions) {
  OdometryRun run;
  run.trajectory = trajectory_of(source, conditions);
  run.trajectory.frame = "camera";
  run.claims = claims_of(run.trajectory, conditions.info.frame_times);
  if (std::ranges::none_of(run.claims, [](const eval::ClaimedPose& claim) {
        return claim.claim == eval::PoseClaim::kLocated;
      }))
    throw InputError(source.run, "has no pose at the time of a frame of " + conditions.info.name);
  run.summary.frames = run.claims.size();
  run.frames_planned = run.claims.size();
  return run;
}

}  // namespace stillpoint::bench
