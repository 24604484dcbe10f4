// SPDX-License-Identifier: BSD-3-Clause
/// Regression test of a program change: classifies each metric over paired runs of base and head.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/analysis/metric_change.h"
#include "bench/analysis/missing_results.h"
#include "bench/analysis/unlike_results.h"
#include "bench/model/stored_run.h"

namespace stillpoint::bench {

enum class CompareSource { kStores, kPrograms };

struct Comparison {
  std::size_t pairs = 0;            ///< runs present in both base and head
  std::size_t compared = 0;         ///< pairs that succeeded on both sides
  std::size_t bit_equal = 0;        ///< compared pairs with bit-equal trajectories
  std::size_t base_failed = 0;      ///< pairs that failed at base
  std::size_t head_failed = 0;      ///< pairs that failed at head
  std::size_t newly_failed = 0;     ///< succeeded at base, but not at head
  std::size_t newly_succeeded = 0;  ///< the reverse
  std::size_t only_in_base = 0;     ///< runs without counterpart
  std::size_t only_in_head = 0;
  std::string first_failure;  ///< "vo on walking_xyz, base: crashed, terminated by signal 11"; empty without
  ChangeClass failures = ChangeClass::kSame;  ///< whether runs fail more often at head, see `failure_class`
  std::vector<MissingResult> missing;         ///< what base has and head lacks
  std::vector<UnlikeResult> unlike;           ///< what both have, but not measured alike: not compared
  bool missing_allowed = false;               ///< then it is listed, but no finding
  TestFamily family;
  std::vector<MetricChange> changes;
  std::vector<MetricChange> control;  ///< base compared with itself; empty if not run
  std::vector<std::string> notes;     ///< remarks, one sentence each

  /// Whether there is a pair of succeeded runs with a metric in common, or with equal trajectories.
  [[nodiscard]] bool has_result() const;
  /// kWorse if runs fail more often at head; kError if all runs of all pairs failed; kInconclusive without a
  /// result, or if something was not measured alike and nothing is worse; else the worst class over all
  /// metrics that decide, and over what is missing at head.
  [[nodiscard]] ChangeClass result() const;
};

/// "12 pairs of runs: 10 compared (4 with bit-equal trajectories), 0 failed at base, 2 at head (2 newly
/// failed, 0 newly succeeded)", and the runs without counterpart if there are any.
[[nodiscard]] std::string count_sentence(const Comparison& comparison);

/// Compares runs that differ only in their build. The tests are exact, and corrected for their number
/// (bench/analysis/metric_change.h).
///
/// Accuracy is tested per variant and sequence, so that a regression on one sequence is not masked by others.
/// The runs of a deterministic program do not scatter, but a different rounding may change a decision and
/// with it the error by several percent. A change is therefore tested against replicates with perturbed input
/// (bench/model/stored_run.h) or other seeds; repetitions with equal trajectories count once. Where the
/// replicates of a sequence are too few for the test, the pairs of all sequences of the variant are pooled,
/// or where these are too few, too, those of all variants; the changes of the single sequences are reported
/// as inconclusive.
///
/// Times and memory are tested per variant over all sequences. Accuracy is not tested if all trajectories are
/// bit-equal.
/// @param source where the runs come from, for advice that applies to it
[[nodiscard]] Comparison compare_runs(std::span<const StoredRun> base, std::span<const StoredRun> head,
                                      CompareSource source = CompareSource::kStores);

/// Control: base compared with itself, repetition 2k with 2k - 1, which have different perturbations. Not
/// corrected for the number of tests, so that it detects small disturbances of the machine.
[[nodiscard]] std::vector<MetricChange> control_changes(std::span<const StoredRun> base);

/// Adds the control. A significant change is set to inconclusive if the metric also changed in the control.
[[nodiscard]] Comparison with_control(Comparison comparison, std::vector<MetricChange> control);

}  // namespace stillpoint::bench
