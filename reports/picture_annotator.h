// SPDX-License-Identifier: BSD-3-Clause
/// Draws what the odometry thought of a picture onto it: boxes, mask, circles, features and their tracks.
#pragma once

#include <map>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/pipeline/runner.h"

namespace stillpoint {

/// Sizes of what is drawn; the circles are those of the tracker. Paper Sec. III-A.
struct AnnotationStyle {
  int stable_radius_px = 0;       ///< 0 = no circles around features
  int unstable_radius_px = 0;     ///< 0 = no circles where features ended
  std::size_t track_length = 10;  ///< pictures
};

/// Call it for each picture in turn: tracks, and places where features ended, come from the ones before.
///
/// Green: stable. Red: on an object. Magenta: moves. White: no verdict yet. Thin orange circles keep new
/// features away from stable ones, purple ones from where a feature ended with the last picture. Red veil:
/// measured depth nearer than its box's threshold. Boxes are yellow where detected and blue where carried.
class PictureAnnotator {
 public:
  explicit PictureAnnotator(AnnotationStyle style) : style_(style) {}

  /// @return CV_8UC3 in the order R, G, B, of the size of the picture
  [[nodiscard]] cv::Mat annotate(const PictureReport& report);

  /// Takes a picture's features into their tracks and draws nothing.
  void follow(const PictureReport& report) { tracks_ = continued(report); }

 private:
  struct Track {
    std::vector<cv::Point2d> pixels;  ///< oldest first
    bool judged = false;
    Verdict verdict = Verdict::kStable;
  };
  using Tracks = std::map<std::int64_t, Track>;

  [[nodiscard]] Tracks continued(const PictureReport& report) const;
  void draw_circles(const Tracks& now, cv::Mat& canvas) const;

  AnnotationStyle style_;
  Tracks tracks_;  ///< of the features in the last picture
};

}  // namespace stillpoint
