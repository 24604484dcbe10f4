// SPDX-License-Identifier: BSD-3-Clause
/// Sparse optical flow between two images by pyramidal Lucas-Kanade (Bouguet 2001), and the image pyramids,
/// which are built in preallocated memory. Paper Sec. III-A.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace stillpoint {

/// Fills the border around an image by reflection without repeating the edge pixel (cv::BORDER_REFLECT_101).
/// @param image CV_8UC1, wider and higher than the border; submatrix of an allocation with that border
void reflect_border(cv::Mat image, int border_px);

/// Smooths by the kernel (1 4 6 4 1) / 16 in both directions and halves the resolution; bit-identical to
/// cv::pyrDown.
/// @param from CV_8UC1 with a reflected border of at least 2 px
/// @param to   CV_8UC1 of half the size, rounded up
/// @param column_sums scratch buffer, reused between calls
void pyr_down(const cv::Mat& from, cv::Mat to, std::vector<std::uint16_t>& column_sums);

/// Content of a pyramid: `track_points_klt` needs derivatives, `track_points_patch` does not.
enum class PyramidKind { kImages, kImagesAndDerivatives };

/// Image pyramid. Rebuilding it with the same size and kind does not allocate.
class ImagePyramid {
 public:
  /// @param gray      CV_8UC1; copied
  /// @param window_px width of the border added around each level
  /// @param levels    including the full resolution; fewer are built if the smallest would be below the
  /// window
  void rebuild(const cv::Mat& gray, int window_px, int levels,
               PyramidKind kind = PyramidKind::kImagesAndDerivatives);

  /// Images, alternating with derivatives if there are any, in the layout of cv::calcOpticalFlowPyrLK.
  [[nodiscard]] const std::vector<cv::Mat>& images() const { return images_; }

  [[nodiscard]] std::size_t levels() const { return images_.size() / images_per_level_; }
  [[nodiscard]] const cv::Mat& level(std::size_t index) const { return images_[images_per_level_ * index]; }

 private:
  void rebuild_images(const cv::Mat& gray, int border_px, int levels);

  std::vector<cv::Mat> images_;
  std::vector<std::uint16_t> column_sums_;  ///< scratch buffer of the filter
  std::size_t images_per_level_ = 1;        ///< entries of images_ per level
  int border_px_ = 0;                       ///< of pyramids without derivatives
};

/// Points of one image to find in another.
struct TrackingRequest {
  const ImagePyramid& from;
  const ImagePyramid& to;
  const std::vector<cv::Point2f>& points;           ///< in `from`
  const std::vector<cv::Point2f>& initial_guesses;  ///< in `to`, one per point; the points if unknown
  int levels = 2;                                   ///< pyramid levels to use, at most those built
};

struct KltSettings {
  int window_px = 21;
  int max_iterations = 30;  ///< per level; default of cv::calcOpticalFlowPyrLK
};

/// Tracking result; the arrays are parallel to the input points.
struct KltResult {
  std::vector<cv::Point2f> pixels;
  std::vector<std::uint8_t> found;  ///< 0: no match, the pixel is undefined
};

/// Finds the points by cv::calcOpticalFlowPyrLK.
[[nodiscard]] KltResult track_points_klt(const TrackingRequest& request, const KltSettings& settings);

}  // namespace stillpoint
