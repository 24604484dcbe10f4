// SPDX-License-Identifier: BSD-3-Clause
/// Continues tracks across large motions, and tracks that were lost with the view, e.g. in blank images.
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
#include "core/geometry/pose_from_points.h"
#include "core/types/frame.h"

namespace stillpoint {

/// Two cases, both by ORB descriptors of the static tracks and other corners of an earlier image, and of the
/// corners of the new one: upright, or, if those give no motion, turned by the orientation of each corner,
/// for a camera that rolls. Matches are nearest neighbors in both directions, at most 64 of 256 bits apart,
/// and at most 0.8 times the distance of the second nearest. With the depths of the earlier image they give
/// the motion of the camera (`estimate_rigid_motion`). Corners whose nearest track is dynamic are left out.
///
/// Large motion: when most tracks of the last image are not found again, or their motion is not consistent,
/// `motion_since_last` predicts where the point tracker finds them.
///
/// A lost view: when less than half of an established view continues nevertheless, or no motion from a view
/// to the next image is found, its image and tracks are kept. Until it returns, each image is compared with
/// them. The point tracker searches all features of known depth where the motion since then predicts them.
/// Those that are found within 3 px continue, if they are a fifth of those in view; those of objects that
/// moved meanwhile, or mistaken for others, do not.
class ViewRecovery {
 public:
  using DynamicIds = std::span<const std::int64_t>;

  ViewRecovery(const FrontendConfig& config, const Camera& camera) : config_(config), camera_(camera) {}

  /// An image with its tracks.
  struct View {
    cv::Mat gray, depth;
    double depth_units_per_m = 1000.0;
    std::vector<Track> tracks;
  };
  [[nodiscard]] const View& last() const { return last_; }

  /// Motion T_now_last of the camera since the last image; nullopt if too few matches agree with one.
  /// @param dynamic_ids of tracks that are no part of the static scene, sorted
  [[nodiscard]] std::optional<Pose> motion_since_last(const cv::Mat& gray, DynamicIds dynamic_ids) const;

  /// @param gray    the new image, and its pyramid
  /// @param tracks  those of the last image that continue in it, sorted by id; if a lost view returns, its
  /// tracks are replaced by those that are found
  void process(const cv::Mat& gray, const ImagePyramid& pyramid, DynamicIds dynamic_ids,
               std::vector<Track>& tracks);

  /// After `process`, if no motion to the new image was found: the last one is a lost view, unless an earlier
  /// one is.
  void break_down(DynamicIds dynamic_ids);

  /// Keeps a frame with all of its tracks, until the next one.
  void remember(const Frame& frame, std::span<const Track> tracks);

  void reset();

 private:
  [[nodiscard]] bool loses_view(std::size_t continued) const;
  void lose_last(DynamicIds dynamic_ids);
  /// Points of a view, with their depths [m]; 0 = not known.
  struct Points {
    std::vector<cv::Point2f> pixels;
    std::vector<double> depths;
  };
  [[nodiscard]] Points points_of(const View& view, DynamicIds dynamic_ids) const;
  [[nodiscard]] std::optional<Pose> motion_since(const View& view, DynamicIds dynamic_ids,
                                                 const cv::Mat& gray) const;
  /// @param matches points of the view in its camera frame, and their bearings now
  [[nodiscard]] std::optional<Pose> common_motion(std::span<const PointObservation> matches) const;
  [[nodiscard]] std::vector<Track> continue_tracks(const View& lost, const Pose& T_now_lost,
                                                   const ImagePyramid& pyramid) const;
  [[nodiscard]] bool fits(const Track& before, const Pose& T_now_lost, const Eigen::Vector2d& bearing) const;

  FrontendConfig config_;
  Camera camera_;
  View last_;                 ///< the last image
  std::optional<View> lost_;  ///< the last image before the loss
  std::vector<std::int64_t> lost_dynamic_ids_;
  int attempts_ = 0;  ///< to recognize the lost view
};

}  // namespace stillpoint
