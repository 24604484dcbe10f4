// SPDX-License-Identifier: BSD-3-Clause
/// The outcome of one run: what its result file says.
#pragma once

#include <string>
#include <vector>

#include "bench/run/odometry_run.h"
#include "eval/score.h"

namespace stillpoint {

enum class RunStatus {
  kOk,
  kInterrupted,  ///< stopped on request: what is there is true but not whole
  kFailed,       ///< ran to the end and found no pose
};

/// "ok", "interrupted" or "failed".
[[nodiscard]] std::string status_name(RunStatus status);

struct RunResult {
  std::string sequence;
  std::string variant;
  std::string mode;
  RunStatus status = RunStatus::kOk;
  std::string failure;             ///< why, when not ok
  std::vector<std::string> notes;  ///< what the reader of the sequence assumed
  Score score;
  OdometryRun run;
};

/// Scores a run against the sequence's ground truth, moved to the camera. A run over a part of the sequence
/// is scored on that part.
[[nodiscard]] RunResult score_run(const SequenceInfo& info, OdometryRun run);

}  // namespace stillpoint
