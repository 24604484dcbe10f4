// SPDX-License-Identifier: BSD-3-Clause
/// Disambiguates variant and sequence names that plans of one page use for different configs or data.
#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/store/store.h"

namespace stillpoint::report {

/// New names by old name and by the hash of the config or data.
struct NameChanges {
  std::map<std::pair<std::string, std::string>, std::string> variants;   ///< by variant, config hash
  std::map<std::pair<std::string, std::string>, std::string> sequences;  ///< by sequence, its id
};

/// A variant whose config, or a sequence whose files, differ from those in an earlier plan gets its plan's
/// name as a suffix: "vo (table2_ablation)". Different seeds or sweep points are not a conflict.
[[nodiscard]] NameChanges disambiguate_names(std::span<const bench::StoredPlan> plans,
                                             std::span<const bench::StoredRun> runs);

[[nodiscard]] std::vector<bench::StoredRun> renamed(std::vector<bench::StoredRun> runs,
                                                    const NameChanges& changes);

}  // namespace stillpoint::report
