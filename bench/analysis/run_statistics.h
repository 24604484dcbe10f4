// SPDX-License-Identifier: BSD-3-Clause
/// Statistics over runs: spread over repetitions, ablation effects, sweep curves, and repeatability, in one
/// store and between two executions of the same run, e.g. on two machines or architectures.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/store/store.h"
#include "eval/statistics/rank_tests.h"

namespace stillpoint::bench {

/// The runs of one variant on one sequence, at one point of a sweep.
struct RunSpread {
  std::string sequence;
  std::string variant;
  std::string axis;
  double axis_value = 0.0;
  std::size_t runs = 0;
  std::size_t failed = 0;              ///< runs that did not succeed
  std::size_t without_value = 0;       ///< succeeded runs without a finite value
  std::size_t copies = 0;              ///< succeeded runs whose result another one has to the bit
  std::optional<eval::Spread> spread;  ///< over replicates of successful runs; `worst`
                                       ///< respects the direction of the metric
  std::string doubt;                   ///< notes of bench/model/run_notes.h; empty without one
};

/// For a deterministic metric, runs with equal trajectories count as one replicate, whatever their seeds: a
/// recorded sequence does not depend on them. Runs without a finite value have no part in the spread.
/// @param runs   that may be pooled, e.g. of one `RunGroup`
/// @param metric metric name, e.g. "ate_rmse_m"
/// @return in the order of first appearance
[[nodiscard]] std::vector<RunSpread> run_spreads(std::span<const StoredRun> runs, const std::string& metric);

/// Spread of a metric over runs of one variant on one sequence, at one point of a sweep, as in `run_spreads`.
/// @return nullopt without a finite value
[[nodiscard]] std::optional<eval::Spread> metric_spread(std::span<const StoredRun* const> runs,
                                                        const std::string& metric);

/// Difference between a variant and a base variant, paired by sequence, seed and point of a sweep.
/// Repetitions are reduced to their median, and pairs of a deterministic metric whose results are copies of
/// another pair count once.
///
/// Over several sequences, each sequence is reduced to the median of its pairs first, and the sequences are
/// the replicates: pairs of one sequence share its effect, so that an interval over all pairs would exclude 0
/// in up to half of the cases without an effect. `count` is then the number of sequences.
struct AblationRow {
  std::string variant;
  std::string sequence;                 ///< empty = all sequences
  std::size_t newly_failed = 0;         ///< pairs in which only the variant did not succeed
  std::size_t newly_without_value = 0;  ///< pairs in which it succeeded, but only base has a value
  std::size_t copies = 0;               ///< pairs that are left out as copies
  std::size_t sequences = 0;            ///< with a pair
  std::optional<eval::PairedDifference> difference;
  std::optional<eval::RelativeChange> change;  ///< nullopt also if a value of 0 changes: only a difference
  /// "coverage 0.33, base 1.00: not comparable" of errors of poses, about the pair in which the coverages
  /// differ most; empty if by at most `kMaxCoverageGap`. Without any pair of runs, the reason: "no seed in
  /// common with the base".
  std::string doubt;
};

/// @param runs that may be pooled, e.g. of one `RunGroup`
/// @param base name of the reference variant
/// @return for each other variant one row over all sequences, followed by one row per sequence
/// @throws InputError if there is no run of `base`; the message lists the existing variants
[[nodiscard]] std::vector<AblationRow> ablation(std::span<const StoredRun> runs, const std::string& base,
                                                const std::string& metric);

/// Repeatability of one run.
struct RepetitionRow {
  std::string label;     ///< sequence, variant, seed
  RunIdentity identity;  ///< of the first repetition
  std::size_t repetitions = 0;
  std::size_t failed = 0;  ///< repetitions that did not succeed
  std::size_t distinct_trajectories =
      0;                         ///< of those that succeeded; one without a trajectory is another one
  std::string first_difference;  ///< "frame 17, optimization"; empty if none, or if not recorded

  /// Whether all repetitions succeeded with one trajectory.
  [[nodiscard]] bool is_repeatable() const {
    return failed == 0 && distinct_trajectories == 1 && first_difference.empty();
  }
};

/// One row for each run with at least two repetitions.
[[nodiscard]] std::vector<RepetitionRow> repetition_report(const Store& store,
                                                           std::span<const StoredRun> runs);

/// First difference between the texts of two frames.csv: "frame 17, optimization"; empty if they are equal.
[[nodiscard]] std::string first_difference(const std::string& frames, const std::string& others);

/// First frame in which the result of a stage differs.
struct StageDifference {
  std::string stage;
  std::optional<std::int64_t> frame;  ///< nullopt: equal in all frames
};

/// For each column of two frames.csv; empty if one is empty or they have different columns.
[[nodiscard]] std::vector<StageDifference> stage_differences(const std::string& frames,
                                                             const std::string& others);

/// Differences between two executions of the same run.
struct ExecutionDifference {
  std::string label;                    ///< sequence, variant, seed
  RunIdentity identity;                 ///< in the first store
  std::string failure;                  ///< "crashed, other ok" if one did not succeed, which is all then
  std::size_t frames = 0;               ///< that both executed
  std::vector<StageDifference> stages;  ///< in the order of execution; empty if not recorded
  bool equal_trajectories = false;      ///< as stored, with nine decimals
  double largest_m = 0.0;               ///< distance between poses of the same time, at most
  double largest_rad = 0.0;             ///< same, angle
  std::optional<double> ate_m;          ///< of either execution
  std::optional<double> other_ate_m;
};

/// One row for each run that both stores contain: the same sequence, config, seed and source code.
/// The poses of both are compared as they are, without alignment: both start at the same pose.
/// @param runs of `store`
[[nodiscard]] std::vector<ExecutionDifference> execution_differences(const Store& store,
                                                                     std::span<const StoredRun> runs,
                                                                     const Store& other);

}  // namespace stillpoint::bench
