// SPDX-License-Identifier: BSD-3-Clause
/// The scored result of one run, the content of its result.json.
#pragma once

#include <string>
#include <vector>

#include "bench/run/odometry_run.h"
#include "eval/score.h"

namespace stillpoint::bench {

enum class RunStatus {
  kOk,
  kInterrupted,  ///< stopped on request; the results cover the processed frames
  kFailed,       ///< processed all frames without any pose
};

/// "ok", "interrupted" or "failed".
[[nodiscard]] std::string status_name(RunStatus status);

struct RunResult {
  std::string sequence;
  std::string variant;
  std::string mode;
  RunStatus status = RunStatus::kOk;
  std::string failure;             ///< reason when not ok
  std::vector<std::string> notes;  ///< assumptions of the sequence reader
  eval::Score score;
  OdometryRun run;
};

/// Scores a run against the sequence's ground truth, transformed to the camera frame. An interrupted run is
/// scored on its processed frames.
[[nodiscard]] RunResult score_run(const datasets::SequenceInfo& info, OdometryRun run);

}  // namespace stillpoint::bench
