// SPDX-License-Identifier: BSD-3-Clause
/// Converts stored runs on OpenLORIS scenes to input of the OpenLORIS benchmark.
#pragma once

#include <span>

#include "bench/store/store.h"
#include "eval/openloris/scene_score.h"

namespace stillpoint::report {

/// Runs on sequences named after an OpenLORIS scene, rendered or recorded, excluding sweeps; each seed counts
/// as one sequence of its scene. `systems` is empty without such runs.
/// @throws InputError if files of a run are missing or damaged
[[nodiscard]] eval::OpenlorisBenchmark openloris_of_runs(const bench::Store& store,
                                                         std::span<const bench::StoredRun> runs);

}  // namespace stillpoint::report
