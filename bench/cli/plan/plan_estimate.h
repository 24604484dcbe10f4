// SPDX-License-Identifier: BSD-3-Clause
/// Expected duration of a plan as text.
#pragma once

#include <filesystem>
#include <string>

#include "bench/plan/plan_matrix.h"

namespace stillpoint::bench {

/// Expected wall time of the runs that are not in the store, with `jobs` concurrent accuracy runs on this
/// machine, and what the expectation is based on. Rendering of sequences is not included.
/// @param store need not exist
[[nodiscard]] std::string estimate_text(const PlanMatrix& matrix, const std::filesystem::path& store,
                                        int jobs);

}  // namespace stillpoint::bench
