// SPDX-License-Identifier: BSD-3-Clause
/// Correction for the number of tests in one comparison, and the number of pairs that it requires.
///
/// A comparison tests m metrics at once: five of accuracy for each variant and sequence, and fourteen of cost
/// for each variant, 150 in all for the plan `quick`. The probability that any metric of an unchanged program
/// is called better or worse shall be at most a = 0.05. Bonferroni's level a / m achieves this for any
/// dependence between the metrics, but spends a part of the error on tests that cannot reject at all: with n
/// pairs an exact test has no p-value below some p* > 0, and none at all where base and head are equal.
/// Tarone (Biometrics 46, 1990) leaves these out:
///
///   K = min{k >= 1: #{j: p*_j <= a / k} <= k},  metric j is significant if p_j <= a / K
///
/// At most K tests can reject at this level, each with probability <= a / K, so the sum is <= a. K is fixed
/// before the signs of the differences are known, because p*_j depends on the number of pairs and ties only.
///
/// Smallest p-values: 2^(1-n) for n pairs (signed-rank test), 2 m! n! / (m + n)! for m and n replicates (rank
/// test of two samples). Replicates on one input need fewer runs: for 150 tests 8 per side, where pairs would
/// have to be 13; pairs are better where inputs or the state of the machine differ. Step-down procedures
/// (Holm) have the same first step, and save no pairs.
#pragma once

#include <cstddef>
#include <span>

#include "bench/model/stored_run.h"

namespace stillpoint::bench {

/// Largest probability of a false statement in one comparison.
inline constexpr double kSignificance = 0.05;

struct TestFamily {
  std::size_t tests = 0;         ///< m
  double level = kSignificance;  ///< largest p-value of a significant change, a / K
};

/// @param smallest_p p*_j of each metric that differs between base and head
[[nodiscard]] TestFamily test_family(std::span<const double> smallest_p);

/// Smallest two-sided p-value of the rank test of two samples; 1 if one is empty.
[[nodiscard]] double smallest_rank_sum_p(std::size_t first, std::size_t second);

/// Smallest number of replicates per side whose rank test reaches a p-value of `level`.
/// @param level in (0, 1]
[[nodiscard]] std::size_t replicates_for(double level);

/// Smallest number of pairs per run with which each metric of a plan can be significant.
/// @param runs the runs of one program, without repetitions
/// @return 1 for runs that count instructions, which need no test
[[nodiscard]] std::size_t pairs_for_plan(std::span<const RunIdentity> runs);

}  // namespace stillpoint::bench
