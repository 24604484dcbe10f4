// SPDX-License-Identifier: BSD-3-Clause
/// What a history shows in one line: text and badge.
#pragma once

#include <string>

#include "bench/analysis/history_changes.h"

namespace stillpoint::report {

/// "0.013", or "exact".
[[nodiscard]] std::string p_label(const bench::SuspectedChange& change);

/// What changed, what is suspected, and what cannot be said yet: "No open regressions. 1 suspected change. 6
/// commits: steps of more than 20 % in accuracy ... could be seen, smaller ones not."
[[nodiscard]] std::string headline(const bench::CommitHistory& history, const bench::HistoryChanges& changes);

/// An SVG image "benchmarks | 1 open regression".
[[nodiscard]] std::string badge_svg(const bench::CommitHistory& history,
                                    const bench::HistoryChanges& changes);

}  // namespace stillpoint::report
