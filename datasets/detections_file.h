// SPDX-License-Identifier: BSD-3-Clause
/// Recorded object boxes, so that a run needs no detector.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/types/detection.h"
#include "datasets/fault_log.h"

namespace stillpoint {

/// Reads rows `timestamp class score x_min y_min x_max y_max` (t in seconds, score in [0, 1], edges in px).
/// Rows of the same stamp make one set. A row of the stamp alone says that the detector looked and found
/// nothing, which is not the same as a stamp that does not occur: then nobody looked. A class name may
/// consist of several words.
/// @return sets in rising order of time, every one `kPresent`
/// @throws InputError if the file is missing, unsorted, or a row is not finite, inverted or out of range
[[nodiscard]] std::vector<DetectionSet> read_detections(const std::filesystem::path& file, FaultLog& faults);

/// The text that `read_detections` reads back: stamps exact, edges to a hundredth of a pixel, scores to a
/// ten-thousandth. Sets that nobody looked for, or that came late, leave no row.
[[nodiscard]] std::string detections_text(std::span<const DetectionSet> sets);

}  // namespace stillpoint
