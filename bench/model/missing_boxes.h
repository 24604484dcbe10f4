// SPDX-License-Identifier: BSD-3-Clause
/// Runs with recorded boxes that lack those of some frames.
#pragma once

#include <string>
#include <vector>

#include "bench/model/stored_run.h"

namespace stillpoint::bench {

/// Footnote about the run with the most frames without recorded boxes: "no recorded boxes in 12 of 240
/// frames", and "in up to 12 of 240 frames" for several runs; empty if there is no such run. Failed runs are
/// ignored.
[[nodiscard]] std::string missing_boxes_note(const std::vector<const StoredRun*>& runs);

}  // namespace stillpoint::bench
