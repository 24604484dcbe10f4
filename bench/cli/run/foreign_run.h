// SPDX-License-Identifier: BSD-3-Clause
/// A finished run of another system, or of any by its trajectory alone, for a diagnosis.
#pragma once

#include <string>
#include <vector>

#include "bench/cli/run/finished_run.h"
#include "bench/run/odometry_run.h"

namespace stillpoint::bench {

/// Whether the run is a trajectory file, or one of another system in a store.
/// @throws InputError if the store has no such run
[[nodiscard]] bool is_foreign(const FinishedRunSource& source);

/// Reads the trajectory of the camera; the frames at its stamps are located, others are not. All else of the
/// run is empty.
/// @throws InputError if the trajectory is missing or malformed or has no pose at the time of a frame, or for
/// a stored run of another sequence, calibration or part, or with other faults
[[nodiscard]] OdometryRun read_foreign_run(const FinishedRunSource& source, const RunConditions& conditions);

}  // namespace stillpoint::bench
