// SPDX-License-Identifier: BSD-3-Clause
/// What the comparison systems share: reading of an exported sequence, the loop over its images, and the
/// files that a system writes (trajectory.tum, timings.json).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "core/types/frame.h"
#include "core/types/rig.h"

namespace stillpoint::rivals {

/// Pose T_w_c of the camera in the world of the first frame; nullopt for a frame that is not located.
using Tracker = std::function<std::optional<Pose>(const Frame& frame)>;

/// @param rig of the sequence
/// @param arguments after those of `run_rival`
using TrackerMaker = std::function<Tracker(const Rig& rig, const std::vector<std::string>& arguments)>;

/// Runs a tracker over all frames: PROGRAM SEQUENCE OUT [arguments]. Writes OUT/trajectory.tum with a row per
/// located frame, and OUT/timings.json with the time of `tracker` per frame [ms]. Errors are printed.
/// @return exit code of the program: 0, or 1 for invalid input
[[nodiscard]] int run_rival(int argc, char** argv, const TrackerMaker& make);

}  // namespace stillpoint::rivals
