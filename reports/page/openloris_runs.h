// SPDX-License-Identifier: BSD-3-Clause
/// Stored runs over scenes of OpenLORIS as its benchmark sees them.
#pragma once

#include <span>

#include "bench/store/store.h"
#include "eval/openloris/scene_score.h"

namespace stillpoint {

/// Runs on sequences named after a scene of OpenLORIS, rendered or recorded, outside sweeps; the seeds are
/// the sequences of the scene. No systems without such runs.
/// @throws InputError if files of a run are missing or damaged
[[nodiscard]] OpenlorisBenchmark openloris_of_runs(const Store& store, std::span<const StoredRun> runs);

}  // namespace stillpoint
