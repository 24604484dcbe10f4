// SPDX-License-Identifier: BSD-3-Clause
/// The two executors of tasks on other machines: over ssh, and as a Slurm job array.
#pragma once

#include <filesystem>
#include <vector>

#include "bench/executors/distribution.h"
#include "bench/executors/hosts.h"

namespace stillpoint::bench {

struct SshOptions {
  std::vector<Host> hosts;
  std::filesystem::path config;  ///< configuration file of ssh; empty = that of the user
};

/// Rsync copies the job folder and the results, GNU parallel starts the workers over ssh and gives the next
/// task to the next idle host. On a host, the folder ~/.stillpoint/jobs/KEY contains the job.
///
/// Hosts that cannot be reached are reported and left out. A recorded sequence is used where the host has it
/// under its name with the same checksum, and copied otherwise. The package of a host is copied once, into
/// its folder ~/.stillpoint/packages.
/// @throws InputError if ssh, rsync or parallel are not installed, no host can be reached, no host has the
/// machine class, or a host has another build or other data
[[nodiscard]] Executor ssh_executor(const PlanMatrix& matrix, const DistributionOptions& options,
                                    const SshOptions& ssh);

/// One array task per task of the job folder, requeued by Slurm if its node fails, and a dependent job that
/// merges their stores. The store must be on a file system that all nodes share, with locks, and this program
/// must have the same path on all of them. Partition, account and time limit are set by the variables of
/// sbatch: SBATCH_PARTITION, SBATCH_ACCOUNT, SBATCH_TIMELIMIT.
///
/// The jobs continue if this program is interrupted or killed; the next call waits for them.
/// @throws InputError if Slurm is not installed, rejects a job, or if the path of the store has a character
/// that Slurm replaces
[[nodiscard]] Executor slurm_executor(const PlanMatrix& matrix, const DistributionOptions& options);

}  // namespace stillpoint::bench
