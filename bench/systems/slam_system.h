// SPDX-License-Identifier: BSD-3-Clause
/// Whatever can be run over a sequence and leaves a trajectory behind.
#pragma once

#include <filesystem>

#include "bench/plan/plan_matrix.h"
#include "bench/process/child_process.h"
#include "bench/store/stored_run.h"

namespace stillpoint {

/// A run that is to be made.
struct RunRequest {
  const PlannedRun& run;
  std::filesystem::path sequence;  ///< folder
  std::filesystem::path work;      ///< folder of its own for what the run writes
  int pictures = 0;                ///< of its worst frames that are wanted
};

/// How a system is started, and how its outcome is read.
class SlamSystem {
 public:
  virtual ~SlamSystem() = default;

  /// @throws InputError if the sequence cannot be brought into the form that the system reads
  [[nodiscard]] virtual ProcessSpec command(const RunRequest& request) const = 0;

  /// What came of a run whose process has ended by itself or by a signal. Costs of the process and its limits
  /// are entered by the caller.
  [[nodiscard]] virtual RunOutcome outcome(const RunRequest& request, const ProcessEnd& end) const = 0;
};

}  // namespace stillpoint
