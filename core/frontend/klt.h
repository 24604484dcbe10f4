// SPDX-License-Identifier: BSD-3-Clause
/// Sparse optical flow between two pictures, by pyramidal Lucas-Kanade (Bouguet 2001). Paper Sec. III-A.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillpoint {

/// Whether a pyramid carries the derivatives that `follow_points` needs; `follow_patches` does not.
enum class PyramidKind { kPictures, kPicturesAndDerivatives };

/// A picture at falling resolutions. Rebuilding one of the same size and kind allocates nothing.
class ImagePyramid {
 public:
  /// @param gray   CV_8UC1, copied, with a border as wide as the window around it
  /// @param levels pictures wanted, the full one included; fewer when the smallest would be below the window
  void rebuild(const cv::Mat& gray, int window_px, int levels,
               PyramidKind kind = PyramidKind::kPicturesAndDerivatives);

  /// Picture and, if there are any, derivatives in turn, as cv::calcOpticalFlowPyrLK takes them.
  [[nodiscard]] const std::vector<cv::Mat>& images() const { return images_; }

  [[nodiscard]] std::size_t levels() const { return images_.size() / step_; }
  [[nodiscard]] const cv::Mat& level(std::size_t index) const { return images_[step_ * index]; }

 private:
  void rebuild_pictures(const cv::Mat& gray, int border_px, int levels);

  std::vector<cv::Mat> images_;
  std::vector<std::uint16_t> sums_;  ///< memory of the filter
  std::size_t step_ = 1;             ///< entries of images_ per level
  int border_px_ = 0;                ///< of pictures without derivatives
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

/// `forward` without the points that do not come back: those that `back`, the search for its matches in the
/// first picture beginning at the original points, lost or found more than `tolerance_px` from the original.
[[nodiscard]] KltResult keep_returning(const std::vector<cv::Point2f>& points, KltResult forward,
                                       const KltResult& back, double tolerance_px);

}  // namespace stillpoint
