// SPDX-License-Identifier: BSD-3-Clause
/// The sentences that matter about a benchmark: what was run, what failed, what is best, what changed.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/compare/comparison.h"
#include "bench/store/stored_run.h"

namespace stillpoint {

/// How many runs of what, and those that did not end well: at most five by name.
[[nodiscard]] std::vector<std::string> outcome_sentences(std::span<const StoredRun> runs);

/// Which variant has the smallest median error on most sequences; empty with fewer than two variants.
[[nodiscard]] std::string best_sentence(std::span<const StoredRun> runs);

/// What became better or worse since an earlier build.
/// @param base name of that build
[[nodiscard]] std::vector<std::string> change_sentences(const std::string& base,
                                                        const Comparison& comparison);

}  // namespace stillpoint
