// SPDX-License-Identifier: BSD-3-Clause
/// Where features should appear in the next picture, by what the IMU says of the motion. Paper Sec. III-A.
#pragma once

#include <opencv2/core/types.hpp>
#include <span>
#include <vector>

#include "core/frontend/frontend_config.h"
#include "core/frontend/track.h"
#include "core/geometry/camera.h"
#include "core/types/motion_prior.h"

namespace stillpoint {

/// The part of `wanted` that the prior can carry: full falls to rotation without a valid translation, both to
/// none without a valid rotation. A prior with numbers that are not finite is not valid.
[[nodiscard]] TrackerPrediction usable_prediction(TrackerPrediction wanted, const MotionPrior& prior);

/// Predicted pixel of each track, distortion included; its present pixel where nothing can be said.
/// With kFull a track moves by rotation and translation at its known depth, and by rotation alone without
/// one; the paper speaks of preintegration without saying which, the published code rotates only.
/// @param kind   what `usable_prediction` returned
/// @param memory for the result
[[nodiscard]] std::vector<cv::Point2f> predict_pixels(std::span<const Track> tracks, const MotionPrior& prior,
                                                      TrackerPrediction kind, const Camera& camera,
                                                      std::vector<cv::Point2f> memory = {});

}  // namespace stillpoint
