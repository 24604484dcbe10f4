// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of runs that differ only in their build, and which runs are replicates of each other.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/model/stored_run.h"

namespace stillpoint::bench {

/// Neither pointer is null.
struct RunPair {
  const StoredRun* base = nullptr;
  const StoredRun* head = nullptr;
};

struct PairedRuns {
  std::vector<RunPair> pairs;                  ///< in the order of base
  std::vector<const StoredRun*> only_in_base;  ///< runs without counterpart
  std::vector<const StoredRun*> only_in_head;
};

/// Pairs runs with equal identities except for build and config, because defaults may change with the build;
/// the seed of a perturbation (bench/model/stored_run.h) must be equal. If this matches several runs of one
/// side, those with the same config hash are paired.
/// @param base, head must outlive the result
[[nodiscard]] PairedRuns paired_runs(std::span<const StoredRun> base, std::span<const StoredRun> head);

[[nodiscard]] bool both_succeeded(const RunPair& pair);

/// Whether both runs have the same trajectory, to the bit.
[[nodiscard]] bool is_bit_equal(const RunPair& pair);

/// Whether repetitions of a run have the same bits by design: of this odometry, but for real time.
[[nodiscard]] bool repeats_by_design(const RunIdentity& identity);

/// Equal for replicates: runs of one variant on the same data with the same seed, of any build and config,
/// and with any repetition and perturbation.
[[nodiscard]] std::string input_key(const RunIdentity& identity);

/// Equal for runs with the same result on the same data: checksum of the data, and the name of the trajectory
/// file, or the metrics of accuracy without one.
/// Repetitions of a deterministic program have one fingerprint, and are not replicates. Empty if the run has
/// neither, or only rates, by which different runs may agree: then it is no copy of another run.
[[nodiscard]] std::string fingerprint(const StoredRun& run);

}  // namespace stillpoint::bench
