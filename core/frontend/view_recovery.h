// SPDX-License-Identifier: BSD-3-Clause
/// Continues the tracks that were lost with the view, e.g. in blank images, when the view returns.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/config/frontend_config.h"
#include "core/frontend/klt/klt.h"
#include "core/frontend/track.h"
#include "core/geometry/camera.h"
#include "core/geometry/pose.h"

namespace stillpoint {

/// When less than half of an established view continues, its image and tracks are kept. Until the view
/// returns, each image is compared with them in two steps:
///   1. Features of the lost view and corners of the image are matched by upright ORB descriptors (nearest
///      neighbors in both directions, at most 64 of 256 bits apart, and at most 0.8 times the distance of the
///      second nearest). The depths of the lost view give the motion of the camera (`estimate_rigid_motion`).
///   2. The point tracker searches all features of known depth where that motion predicts them. Those that
///      are found within 3 px continue; those of objects that moved meanwhile, or mistaken for others, do
///      not.
class ViewRecovery {
 public:
  ViewRecovery(const FrontendConfig& config, const Camera& camera) : config_(config), camera_(camera) {}

  /// @param gray    the new image, and its pyramid
  /// @param tracks  those of the last image that continue in it, sorted by id; if a lost view returns, its
  /// tracks are replaced by those that are found
  void process(const cv::Mat& gray, const ImagePyramid& pyramid, std::vector<Track>& tracks);

  /// Keeps an image with all of its tracks, until the next one.
  void remember(const cv::Mat& gray, std::span<const Track> tracks);

  void reset();

 private:
  struct View {
    cv::Mat gray;
    std::vector<Track> tracks;
  };
  [[nodiscard]] bool loses_view(std::size_t continued) const;
  [[nodiscard]] std::optional<Pose> motion_since(const View& lost, const cv::Mat& gray) const;
  [[nodiscard]] std::vector<Track> continue_tracks(const View& lost, const Pose& T_now_lost,
                                                   const ImagePyramid& pyramid) const;
  [[nodiscard]] bool fits(const Track& before, const Pose& T_now_lost, const Eigen::Vector2d& bearing) const;

  FrontendConfig config_;
  Camera camera_;
  View last_;                 ///< the last image
  std::optional<View> lost_;  ///< the last image before the loss
  int attempts_ = 0;          ///< to recognize the lost view
};

}  // namespace stillpoint
