// SPDX-License-Identifier: BSD-3-Clause
/// Bookkeeping of landmarks and observations when frames enter or leave the window.
#pragma once

#include "core/backend/window/window.h"
#include "core/config/backend_config.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// Changes the lens correction of a window and the bearings of its observations.
void set_lens(const Eigen::Vector4d& lens, Window& window);

/// Adds the tracked features of the newest frame as observations; unknown ids become new landmarks.
/// @param frame features sorted by id; those whose bearing is not finite are ignored
void add_observations(const TrackedFrame& frame, const Rig& rig, const DepthConfig& config, Window& window);

/// Whether the second-newest frame becomes a keyframe, that is, stays in the window. It does if its
/// predecessor (the last keyframe) shares too few static landmarks with the newest frame, if its mean
/// parallax to that keyframe is large enough, or if the keyframe is too old. Qin et al. 2018, Sec. IV-A; the
/// ratio `keyframe_min_shared_ratio` is our own.
[[nodiscard]] bool is_second_newest_keyframe(const Window& window, const BackendConfig& config,
                                             double focal_px);

/// Removes the oldest frame; its landmarks are re-hosted in the next frame.
void remove_oldest_frame(Window& window);

/// Removes the second-newest frame; its inertial samples are merged into the newest frame's preintegration.
void remove_second_newest_frame(Window& window);

/// Removes the newest frame, whose pose was not found; the next frame continues the tracks.
void remove_newest_frame(Window& window);

/// Restarts a landmark at its newest observation; earlier ones belong to another point.
void restart_track(Landmark& landmark);

/// The landmarks that the newest frame observes, as those of a window of this frame alone: with one
/// observation, and without the depth that was estimated.
/// @param lens correction of that window
[[nodiscard]] std::vector<Landmark> landmarks_of_newest(const Window& window, const Eigen::Vector4d& lens);

}  // namespace stillpoint
