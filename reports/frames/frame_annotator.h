// SPDX-License-Identifier: BSD-3-Clause
/// Draws odometry results onto a frame: detections, semantic mask, circular masks, features and their tracks.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/pipeline/runners/runner.h"

namespace stillpoint::report {

/// Drawing sizes; the circles are the tracker's circular masks. Paper Sec. III-A.
struct AnnotationStyle {
  int stable_radius_px = 0;       ///< 0 = no circles around features
  int unstable_radius_px = 0;     ///< 0 = no circles where tracking was lost
  std::size_t track_length = 10;  ///< frames
};

/// Call it for every frame in order: tracks and lost features are derived from the preceding frames.
///
/// Green: stable. Red: on a dynamic object. Magenta: moving (moving consistency check). White: no label yet.
/// Thin circles suppress new features: orange around stable features, purple where a feature was lost in the
/// last frame (unstable). Red tint: depth below its box's threshold, Eq. (1). Boxes: yellow detected, blue
/// from missed detection compensation. After a correction by loop closure its size is written for 30 frames.
class FrameAnnotator {
 public:
  explicit FrameAnnotator(AnnotationStyle style) : style_(style) {}

  /// @return CV_8UC3 RGB, same size as the frame
  [[nodiscard]] cv::Mat annotate(const FrameReport& report);

  /// Updates the tracks without drawing.
  void update_tracks(const FrameReport& report) { tracks_ = extended_tracks(report); }

 private:
  struct Track {
    std::vector<cv::Point2d> pixels;  ///< oldest first
    bool has_label = false;
    LabelClass label = LabelClass::kStable;
  };
  using Tracks = std::map<std::int64_t, Track>;

  [[nodiscard]] Tracks extended_tracks(const FrameReport& report) const;
  void note_correction(const OdometryUpdate& update);
  void draw_circles(const Tracks& now, cv::Mat& canvas) const;

  AnnotationStyle style_;
  Tracks tracks_;       ///< of the features in the last frame
  Pose T_m_w_;          ///< `OdometryUpdate::T_m_w` of the last frame that was drawn
  bool in_map_ = true;  ///< same
  std::string correction_;
  int correction_frames_ = 0;  ///< for which it is still written
};

}  // namespace stillpoint::report
