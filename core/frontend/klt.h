// SPDX-License-Identifier: BSD-3-Clause
/// Sparse optical flow between two pictures, by pyramidal Lucas-Kanade (Bouguet 2001). Paper Sec. III-A.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillpoint {

/// A picture at falling resolutions with its derivatives. Rebuilding one of the same size allocates nothing.
class ImagePyramid {
 public:
  /// @param gray   CV_8UC1, copied
  /// @param levels pictures wanted, the full one included; fewer when the smallest would be below the window
  void rebuild(const cv::Mat& gray, int window_px, int levels);

  /// Picture and derivatives in turn, as cv::calcOpticalFlowPyrLK takes them.
  [[nodiscard]] const std::vector<cv::Mat>& images() const { return images_; }

 private:
  std::vector<cv::Mat> images_;
};

struct KltSettings {
  int window_px = 21;
  int levels = 2;  ///< pyramid levels to use, at most those built
  int max_iterations = 30;
};

/// Where points went. The arrays run parallel to the points asked for.
struct KltResult {
  std::vector<cv::Point2f> pixels;
  std::vector<std::uint8_t> found;  ///< 0: no match; the pixel then means nothing
};

/// Finds `points` of picture `from` in picture `to`.
/// @param guesses where to begin, one per point; the points themselves when nothing is known
[[nodiscard]] KltResult follow_points(const ImagePyramid& from, const ImagePyramid& to,
                                      const std::vector<cv::Point2f>& points,
                                      const std::vector<cv::Point2f>& guesses, const KltSettings& settings);

/// `forward` without the points that do not come back: followed from their match to picture `from`,
/// beginning at the original, they end more than `tolerance_px` from it. Full resolution only.
[[nodiscard]] KltResult check_backward(const ImagePyramid& from, const ImagePyramid& to,
                                       const std::vector<cv::Point2f>& points, KltResult forward,
                                       const KltSettings& settings, double tolerance_px);

}  // namespace stillpoint
