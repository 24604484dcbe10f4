// SPDX-License-Identifier: BSD-3-Clause
/// A stored run as a recording for viewers, with the topics of run_recording.h as far as the store has them:
///
/// | topic | from |
/// |---|---|
/// | /estimate, /estimate/path | trajectory.tum; segments after a loss are not in it |
/// | /truth, /truth/path | the stored ground truth of the camera |
/// | /tf | world to camera; world to truth, aligned by the first located frame |
/// | /status | counters.csv, and the segments of status.csv; without the reason |
/// | /claims | stillpoint.Claim: status.csv, in place of /state with the whole covariance |
/// | /timings | timings.csv |
/// | /loops | loops.csv, without the relative pose |
/// | /camera/image | the annotated images of the worst frames |
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/store/store.h"

namespace stillpoint::report {

/// What a recording of a stored run does not contain, because the store does not: "inertial samples" ...
struct StoredRecording {
  std::vector<std::string> missing;
};

/// Writes the recording.
/// @param file must not exist
/// @throws InputError if the run has neither poses nor counters, a time is negative, or the file cannot be
/// written
StoredRecording write_stored_recording(const std::filesystem::path& file, const bench::Store& store,
                                       const bench::StoredRun& run);

}  // namespace stillpoint::report
