// SPDX-License-Identifier: BSD-3-Clause
/// What base has and head lacks: variants, sequences, runs, poses, metrics and modules. An infinite value or
/// a missing one ("n/a") is worse than any number, but is in no rank test; it is counted here.
///
/// Whether head lacks something that base has more often than the reverse, over n pairs of runs of which f
/// lack it at head only and s at base only:
///
///   more often   s = 0 and f > 0, or f > s and P(B >= f) <= 0.05,  B ~ binomial(f + s, 1/2)
///
/// (McNemar's exact test, Psychometrika 12, 1947). The case s = 0 is no test: a gate does not wait for the
/// fifth crash of a program that never crashed before.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/analysis/metric_change.h"
#include "bench/analysis/paired_runs.h"

namespace stillpoint::bench {

/// kMissing if head lacks it more often by the rule above; kInconclusive if only f > s; kBetter if the
/// reverse holds by the rule; else kSame.
/// @param lost   f
/// @param gained s
[[nodiscard]] ChangeClass loss_class(std::size_t lost, std::size_t gained);

/// Something that base has and head lacks.
struct MissingResult {
  /// "variant", "sequence", "runs", "half of the poses", "metric ate_rmse_m" or "module window_solve".
  std::string what;
  std::string subject;   ///< variant, "variant on sequence", or sequence
  std::size_t base = 0;  ///< runs of base that have it
  std::size_t head = 0;  ///< runs of head that have it, among the counterparts of these
  /// kMissing if head lacks it in all runs, or more often by the rule above over all sequences of the
  /// variant; kInconclusive if more often, but not by this rule, or if head has less than half of the runs
  /// of a variant on a sequence; else kSame.
  ChangeClass result = ChangeClass::kMissing;
};

/// Whether a stored metric or module must have a value if an earlier run has one.
[[nodiscard]] bool must_exist(const std::string& name);

/// Variants and sequences without any run of head first, then those with few runs of head, then poses,
/// metrics and modules of pairs that succeeded on both sides: poses are missing if head locates less than
/// half of the frames that base does. Metrics of the machine (`MetricSource::kMachine`, `kDevice`), and those
/// whose absence is good (`MetricGate::absent_is_good`) are not listed.
[[nodiscard]] std::vector<MissingResult> missing_results(const PairedRuns& runs);

/// Whether runs fail more often at head than at base: kWorse if all runs of a variant on a sequence fail that
/// succeeded at base, or if a variant fails more often by the rule above over all its sequences; else as
/// `loss_class` over all variants.
[[nodiscard]] ChangeClass failure_class(const PairedRuns& runs);

/// "variant", with the point of a sweep if there is one.
[[nodiscard]] std::string variant_label(const RunIdentity& identity);

/// "variant on sequence".
[[nodiscard]] std::string subject_label(const RunIdentity& identity);

}  // namespace stillpoint::bench
