// SPDX-License-Identifier: BSD-3-Clause
/// Keeps the landmarks' observations in step with the frames of the window.
#pragma once

#include "core/backend/backend_config.h"
#include "core/backend/window.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// Adds what the tracker saw in the window's newest frame; unknown ids become new landmarks.
/// @param frame features by rising id
void add_observations(const TrackedFrame& frame, const Rig& rig, const DepthConfig& config, Window& window);

/// Whether the frame before the newest should stay in the window: its predecessor, the last keyframe, shares
/// few still landmarks with the newest, or it moved enough against that one, or that one is long past.
/// Qin et al. 2018, Sec. IV-A; the share is our own.
[[nodiscard]] bool is_second_newest_keyframe(const Window& window, const BackendConfig& config,
                                             double focal_px);

/// Drops the oldest frame; landmarks hosted there move to the next frame that saw them.
void remove_oldest_frame(Window& window);

/// Drops the frame before the newest; its inertial samples go to the newest.
void remove_second_newest_frame(Window& window);

/// Begins the landmark anew with its newest observation: what was seen before was another point.
void forget_past(Landmark& landmark);

}  // namespace stillpoint
