// SPDX-License-Identifier: BSD-3-Clause
/// Reads and writes recorded object detections (`detections.txt`), which replace a detector during a run.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/types/detection.h"

namespace stillpoint::datasets {

/// Reads rows `timestamp class score x_min y_min x_max y_max` (t in seconds, score in [0, 1], edges in px).
/// Rows with the same timestamp form one set. A row with only a timestamp means that the detector ran and
/// found nothing; a timestamp that does not occur means that it did not run. A class name may consist of
/// several words.
/// @return sets in increasing order of time, all `kPresent`
/// @throws InputError if the file is missing or unsorted, or a box or score is not finite, inverted or out of
/// range
[[nodiscard]] std::vector<DetectionSet> read_detections(const std::filesystem::path& file, FaultLog& faults);

/// `read_detections` of the text of a file. @param name of the file, for errors
[[nodiscard]] std::vector<DetectionSet> parse_detections(const std::string& text, const std::string& name,
                                                         FaultLog& faults);

/// First line of `detections_text`.
[[nodiscard]] std::string detections_header();

/// Inverse of `read_detections`: timestamps exact, edges rounded to 0.01 px, scores to 0.0001. Sets that are
/// not `kPresent` are omitted.
[[nodiscard]] std::string detections_text(std::span<const DetectionSet> sets);

}  // namespace stillpoint::datasets
