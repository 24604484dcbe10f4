// SPDX-License-Identifier: BSD-3-Clause
/// One commit: what changed with it, and its numbers beside those of the commit before.
#pragma once

#include <string>

#include "bench/compare/history_changes.h"

namespace stillpoint {

/// A page that needs nothing but itself, and no scripts.
/// @param commit index
[[nodiscard]] std::string commit_html(const CommitHistory& history, const HistoryChanges& changes,
                                      std::size_t commit);

}  // namespace stillpoint
