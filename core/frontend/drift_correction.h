// SPDX-License-Identifier: BSD-3-Clause
/// Aligns each track with the image where it began. Not in the paper.
#pragma once

#include <span>

#include "core/config/frontend_config.h"
#include "core/frontend/klt/klt.h"
#include "core/frontend/track.h"
#include "core/geometry/camera.h"
#include "core/types/frame.h"

namespace stillpoint {

/// A patch that is tracked from frame to frame is taken anew from each image, and the errors of all steps
/// accumulate. Therefore the match in a frame is only the initial guess of an alignment with the patch of the
/// track's first image (Matthews, Ishikawa and Baker 2004, "The template update problem", strategy 3). Where
/// the alignment finds nothing within 1 px, or has a correlation below `drift_min_correlation`, the match is
/// used as it is, and the track continues with the patch of this frame as its first.
///
/// The first patch is warped as a plane parallel to the image plane would appear (Forster, Pizzoli and
/// Scaramuzza 2014, Sec. IV-B, with the measured depths). With x = (x, y, 1) the ray in the frame, z its
/// depth, z_0 that in the first image, R = R_now_first and e_1, e_2 the first unit vectors:
///   A_image_template = (z_0 / z) [1 0 -x; 0 1 -y] R [e_1 e_2].
/// An unknown depth counts as unchanged.
class DriftCorrector {
 public:
  DriftCorrector(const FrontendConfig& config, const Camera& camera) : config_(config), camera_(camera) {}

  /// Records a rotation of the camera since the last call.
  static void rotate(const Eigen::Matrix3d& R_now_before, std::span<Track> tracks);

  /// Replaces matches by aligned ones.
  /// @param matches of `tracks` in `frame`, found by tracking from the previous frame
  /// @param pyramid of the frame
  void correct(const Frame& frame, const ImagePyramid& pyramid, std::span<Track> tracks,
               KltResult& matches) const;

  /// Begins the first view of tracks without one. @param pyramid of the frame of the last observations
  static void begin_views(const ImagePyramid& pyramid, std::span<Track> tracks);

 private:
  [[nodiscard]] Eigen::Matrix2d warp(const FirstView& first, const Frame& frame,
                                     const Eigen::Vector2d& pixel) const;

  FrontendConfig config_;
  Camera camera_;
};

}  // namespace stillpoint
