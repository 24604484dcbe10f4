// SPDX-License-Identifier: BSD-3-Clause
/// Summary sentences of a report: number of runs, failures, best variant, changes since an earlier build.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/analysis/comparison.h"
#include "bench/model/stored_run.h"

namespace stillpoint::report {

/// Number of runs, and the failed ones; at most five are listed individually.
[[nodiscard]] std::vector<std::string> outcome_sentences(std::span<const bench::StoredRun> runs);

/// The variant with the smallest median ATE on most sequences; empty with fewer than two variants.
[[nodiscard]] std::string best_sentence(std::span<const bench::StoredRun> runs);

/// Metrics that improved or regressed since an earlier build.
/// @param base name of that build
[[nodiscard]] std::vector<std::string> change_sentences(const std::string& base,
                                                        const bench::Comparison& comparison);

}  // namespace stillpoint::report
