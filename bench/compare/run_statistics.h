// SPDX-License-Identifier: BSD-3-Clause
/// What repeated runs say: spreads, what an ablation is worth, curves of a sweep, and whether repetitions are
/// equal.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/store/store.h"
#include "eval/statistics/paired.h"

namespace stillpoint {

/// The runs of one variant on one sequence, at one point of a sweep.
struct RunSpread {
  std::string sequence;
  std::string variant;
  std::string axis;
  double axis_value = 0.0;
  std::size_t runs = 0;
  std::size_t failed = 0;        ///< did not end well
  std::optional<Spread> spread;  ///< over those that ended well
};

/// @param metric name, e.g. "ate_rmse_m"
/// @return in the order of first appearance
[[nodiscard]] std::vector<RunSpread> run_spreads(std::span<const StoredRun> runs, const std::string& metric);

/// A variant against another, paired by sequence, seed and point of a sweep; of repetitions the median
/// counts.
struct AblationRow {
  std::string variant;
  std::string sequence;  ///< empty: over all sequences
  std::size_t lost = 0;  ///< pairs in which only the variant did not end well
  std::optional<PairedDifference> difference;
  std::optional<RelativeChange> change;
};

/// @param base the variant against which the others are held
/// @return for each other variant a row over all sequences, then one for each sequence
/// @throws InputError if no run is of that variant, naming those that are
[[nodiscard]] std::vector<AblationRow> ablation(std::span<const StoredRun> runs, const std::string& base,
                                                const std::string& metric);

/// Whether repetitions of one run gave the same bits.
struct RepetitionRow {
  std::string label;  ///< sequence, variant, seed
  std::size_t repetitions = 0;
  std::size_t distinct_trajectories = 0;
  std::string
      first_difference;  ///< "frame 17, optimization"; empty if there is none or states were not recorded
};

/// Runs that were made at least twice.
[[nodiscard]] std::vector<RepetitionRow> repetition_report(const Store& store,
                                                           std::span<const StoredRun> runs);

/// Where two texts of frames.csv part: "frame 17, optimization"; empty if they do not.
[[nodiscard]] std::string first_difference(const std::string& frames, const std::string& others);

}  // namespace stillpoint
