// SPDX-License-Identifier: BSD-3-Clause
/// Execution of tasks as a Slurm job array: one array task per task of the job folder, requeued by Slurm if
/// its node fails, and a dependent job that merges their stores. The store must be on a file system that all
/// nodes share, with locks, and this program must have the same path on all of them. Partition, account and
/// time limit are set by the variables of sbatch: SBATCH_PARTITION, SBATCH_ACCOUNT, SBATCH_TIMELIMIT.
#pragma once

#include "bench/executors/distribution.h"

namespace stillpoint::bench {

/// The jobs continue if this program is interrupted or killed; the next call waits for them.
/// @throws InputError if Slurm is not installed, rejects a job, or if the path of the store has a character
/// that Slurm replaces
[[nodiscard]] Executor slurm_executor(const PlanMatrix& matrix, const DistributionOptions& options);

}  // namespace stillpoint::bench
