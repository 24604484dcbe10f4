// SPDX-License-Identifier: BSD-3-Clause
/// Scores the OpenLORIS runs of a plan by scene: the sequences of a scene are joined as in the tools of the
/// dataset (Shi et al., ICRA 2020), with one alignment and rates weighted by time.
#pragma once

#include <filesystem>
#include <string>

#include "bench/plan/plan_matrix.h"
#include "bench/store/store.h"

namespace stillpoint::bench {

/// Writes the trajectories and the ground truth in the format of the tools to OUT/openloris, and the figure
/// of the paper to OUT/openloris_figure.svg.
/// @return the table of scores; empty without a completed run
/// @throws InputError if a file cannot be read or written
[[nodiscard]] std::string openloris_scene_table(const PlanMatrix& matrix, const Store& store,
                                                const std::filesystem::path& out);

}  // namespace stillpoint::bench
