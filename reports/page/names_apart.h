// SPDX-License-Identifier: BSD-3-Clause
/// Plans that share a page may mean different things by one name; their numbers must not meet in one cell.
#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/store/store.h"

namespace stillpoint {

/// New names by old name and by the hash of what is meant.
struct NameChanges {
  std::map<std::pair<std::string, std::string>, std::string> variants;   ///< by variant, config hash
  std::map<std::pair<std::string, std::string>, std::string> sequences;  ///< by sequence, its id
};

/// A variant with another config, or a sequence with other files, than in a plan before gets the name of its
/// plan: "vo (table2_ablation)". Seeds and points of sweeps are no such difference.
[[nodiscard]] NameChanges names_apart(std::span<const StoredPlan> plans, std::span<const StoredRun> runs);

[[nodiscard]] std::vector<StoredRun> renamed(std::vector<StoredRun> runs, const NameChanges& changes);

}  // namespace stillpoint
