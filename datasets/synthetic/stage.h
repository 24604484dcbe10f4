// SPDX-License-Identifier: BSD-3-Clause
/// Everything that is settled before the first frame of a sequence is rendered.
#pragma once

#include <vector>

#include "core/types/rig.h"
#include "core/types/trajectory.h"
#include "datasets/synthetic/actor.h"
#include "datasets/synthetic/frame_renderer.h"
#include "datasets/synthetic/imu_model.h"
#include "datasets/synthetic/path_spline.h"
#include "datasets/synthetic/presets.h"
#include "datasets/synthetic/scenes.h"

namespace stillpoint {

struct Stage {
  Scene scene;
  PathSpline body_path;      ///< over the path's own time [s]
  Rig rig;                   ///< as the sequence's files will state it
  Timestamp epoch;           ///< stamp of path time 0
  double first_frame_s = 0;  ///< path time of the first picture
  InertialRecord inertia;
  std::vector<Actor> actors;
};

[[nodiscard]] Stage make_stage(const SynthRequest& request);

/// Stamps of the pictures that arrive, in whole microseconds: the ideal times less those that the camera
/// dropped.
[[nodiscard]] std::vector<Timestamp> frame_times(const SynthRequest& request, const Stage& stage);

/// Camera poses of the frame stamped `t`, whose stamp is the middle of the middle row's exposure.
/// @param span_s length of the time over which movers are given, centred on the stamp
[[nodiscard]] Shot shot_at(const SynthRequest& request, const Stage& stage, Timestamp t, double span_s);

/// Poses of the camera every 5 ms (200 Hz), from just before the first picture to just after the last.
[[nodiscard]] Trajectory camera_truth(const SynthRequest& request, const Stage& stage);

}  // namespace stillpoint
