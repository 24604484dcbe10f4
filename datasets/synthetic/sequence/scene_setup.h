// SPDX-License-Identifier: BSD-3-Clause
/// Scene, trajectory, IMU samples and actors of a sequence, computed before the first frame is rendered.
#pragma once

#include <limits>
#include <vector>

#include "core/types/rig.h"
#include "core/types/trajectory.h"
#include "datasets/synthetic/actors/actor.h"
#include "datasets/synthetic/motion/path_spline.h"
#include "datasets/synthetic/render/frame_renderer.h"
#include "datasets/synthetic/scenes/scenes.h"
#include "datasets/synthetic/sequence/presets.h"
#include "datasets/synthetic/sequence/recorded_motion.h"

namespace stillpoint::synth {

struct SceneSetup {
  Scene scene;
  PathSpline body_path;      ///< as a function of path time [s]
  Rig rig;                   ///< calibration written to the sequence
  Timestamp epoch;           ///< timestamp of path time 0
  double first_frame_s = 0;  ///< path time of the first frame
  ImuRecord imu;
  std::vector<Actor> actors;
  double change_s = std::numeric_limits<double>::infinity();  ///< path time of `Scene::change`
};

[[nodiscard]] SceneSetup make_scene_setup(const SynthRequest& request);

/// Timestamps of all frames that are not dropped, in whole microseconds.
/// @throws InputError if the recorded times of the request cannot be read
[[nodiscard]] FrameTimes frame_times(const SynthRequest& request, const SceneSetup& setup);

/// Camera poses of the frame with timestamp `t`, the middle of the middle row's exposure.
/// @param span_s length of the time interval, centered on `t`, over which actor motion is interpolated
[[nodiscard]] Exposure exposure_at(const SynthRequest& request, const SceneSetup& setup, Timestamp t,
                                   double span_s);

/// Camera poses T_w_c at the times of the color images, and at 200 Hz from just before the first frame to
/// just after the last. Metrics that associate a frame with the nearest pose then have no error of
/// association: with 200 Hz alone it is up to 2.5 ms, that is, 0.2 degrees at 80 deg/s.
[[nodiscard]] Trajectory camera_ground_truth(const SynthRequest& request, const SceneSetup& setup,
                                             const std::vector<Timestamp>& color_times);

}  // namespace stillpoint::synth
