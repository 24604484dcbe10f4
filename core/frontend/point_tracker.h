// SPDX-License-Identifier: BSD-3-Clause
/// Tracks points from one frame to the next: the positions predicted from the IMU are the initial guesses of
/// the point tracker that the config selects, OpenCV's pyramidal KLT or 8x8 patches. Paper Sec. III-A.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/config/frontend_config.h"
#include "core/frontend/klt/klt.h"
#include "core/frontend/track.h"
#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// Most complete prediction up to `wanted` that the prior supports: kFull falls back to kRotation without a
/// valid translation, and both to kNone without a valid rotation. Non-finite values make a prior invalid.
[[nodiscard]] TrackerPrediction usable_prediction(TrackerPrediction wanted, const MotionPrior& prior);

/// Motion by which features are predicted.
struct FeatureMotion {
  const MotionPrior& prior;
  TrackerPrediction kind;  ///< as returned by `usable_prediction`
};

/// Predicted pixel of each track, the initial guess of KLT in the current frame:
///   kFull:     u_cur = proj(R_ccur_cprev m + t_ccur_cprev / d)
///   kRotation: u_cur = proj(R_ccur_cprev m), also used by kFull for tracks without known depth
///   kNone:     u_cur = u_prev
/// where m = (x, y, 1) are the normalized coordinates of the track in the previous frame, d is its depth [m],
/// and proj is `Camera::project`, including distortion. Tracks that would leave the field of view stay at
/// u_prev. The paper does not state whether translation is used; the published code rotates only.
/// @param recycled buffer reused for the result
[[nodiscard]] std::vector<cv::Point2f> predict_pixels(std::span<const Track> tracks,
                                                      const FeatureMotion& motion, const Camera& camera,
                                                      std::vector<cv::Point2f> recycled = {});

/// The pyramid that `track_points` needs.
/// @param recycled a pyramid that is no longer needed; its memory is reused
[[nodiscard]] ImagePyramid build_pyramid(const FrontendConfig& config, const cv::Mat& gray,
                                         ImagePyramid recycled = {});

/// Tracks to find after a large motion.
struct LargeMotion {
  const cv::Mat& gray;                        ///< image of the tracks
  std::span<const Track> tracks;              ///< of that image
  const Pose& T_now_before;                   ///< motion since then
  const ImagePyramid& now;                    ///< of the new image
  const std::vector<cv::Point2f>& predicted;  ///< initial guesses in the new image, by `predict_pixels`
};

/// Finds tracks by `track_points`, after a roll of more than 20 degrees from their image turned as the camera
/// has: the point tracker takes patches to be displaced only.
[[nodiscard]] KltResult track_large_motion(const FrontendConfig& config, const Camera& camera,
                                           const LargeMotion& motion);

/// @param recycled buffers reused for the result
[[nodiscard]] KltResult track_points(const FrontendConfig& config, const TrackingRequest& request,
                                     KltResult recycled = {});

}  // namespace stillpoint
