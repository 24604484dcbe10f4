// SPDX-License-Identifier: BSD-3-Clause
/// Segmentation-like masks from boxes and depth. Paper Sec. III-C, Eqs. (1)-(2).
///
/// A feature at pixel u with depth d is dynamic if u lies in the box of an object and d < d_bar, Eq. (2).
///
/// `dynamic.mask` selects how the depth range of an object is computed:
///   "depth_threshold"  Eq. (2): bench/configs/dynamic_vins.toml and dynamic_vins_vo.toml
///   "depth_band"       object_depth_band, not in the paper: the default, and the overlay
///                      ablations/depth_band.toml
///   "whole_box"        d_bar = +inf: the overlay ablations/wo_seg_like_mask.toml
///   "off"              no mask: baselines/vins_rgbd.toml and baselines/vins_mono.toml
/// All other files in bench/configs/ are overlays that do not change the mask.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/config/dynamic_config.h"
#include "core/types/detection.h"

namespace stillpoint {

/// A depth image registered to the color camera, in raw sensor units.
struct DepthView {
  cv::Mat pixels;  ///< CV_16UC1, 0 = not measured; may be empty
  double units_per_m = 1000.0;
};

/// Largest window of `median_depth`.
inline constexpr int kMaxDepthWindow_px = 31;

/// Median of the valid depths in a square window around a pixel [m]; the upper median for an even count; 0 if
/// the window has no valid depth. The window is clipped to the image.
/// @param depth may be empty, which gives 0
/// @param pixel center of the window, rounded
/// @param window_px side of the window, odd, at most kMaxDepthWindow_px
[[nodiscard]] double median_depth(const DepthView& depth, const Eigen::Vector2d& pixel, int window_px);

/// Depths in [near_m, far_m) belong to the object.
struct DepthBand {
  double near_m = 0.0;
  double far_m = std::numeric_limits<double>::infinity();
};

/// Depth interval of the object in a box (`dynamic.mask = "depth_band"`), an alternative to Eq. (2) that is
/// not part of the paper: the interval around the mode of a center-weighted depth histogram.
///
///   h(b)   = sum of exp(-rho_k^2 / (2 * 0.6^2)) over the samples k whose depth lies in bin b
///   b*     = argmax_b h(b)
///   [l, u] = largest run of bins around b* with h(b) >= 0.1 h(b*) and |b - b*| <= ceil(extent_m / 0.1 m)
///   result = [(l - 1) * 0.1 m, (u + 2) * 0.1 m)
///
/// with 24 x 24 samples k on a regular grid over the box, rho_k the distance of a sample from the box center
/// in half side lengths, and bins b of 0.1 m up to 15 m. Unlike Eq. (2) it does not depend on single corner
/// or center pixels, keeps features in front of the object, and finds legs in a box whose center shows the
/// wall between them.
///
/// @param depth    may be empty
/// @param box      with positive area; may exceed the image
/// @param extent_m maximum extent of the object to either side of the mode [m], > 0
/// @return [0, inf) if the box has no valid depth
[[nodiscard]] DepthBand object_depth_band(const DepthView& depth, const Box& box, double extent_m);

/// Depths sampled on one detection box [m]; 0 = invalid.
struct BoxDepths {
  std::array<double, 4> corners{};  ///< d_tl, d_tr, d_bl, d_br: top left, top right, bottom left and right
  double center = 0.0;              ///< d_c
};

/// Depth threshold d_bar of the K-th box; a feature inside the box with d < d_bar belongs to the object.
///
/// Eq. (1), the largest background depth:
///
///   d_max = max(d_tl, d_tr, d_bl, d_br)
///
/// Eq. (2):
///
///           | (d_max + d_c) / 2   if d_max - d_c >  epsilon and d_c > 0   clear gap to the background
///   d_bar = | d_c + epsilon       if d_max - d_c <= epsilon and d_c > 0   object close to it or occluded
///           | d_max               if d_max > 0 and d_c = 0                center not measured
///           | +inf                otherwise                               nothing measured: whole box
///
/// with d_tl, d_tr, d_bl, d_br the depths at the corners of the box and d_c the depth at its center [m]; a
/// depth of 0 means "not measured". epsilon is a predefined distance [m]: the typical depth extent of a
/// dynamic object. The paper writes `<` in the second case, which would send d_max - d_c = epsilon to +inf. A
/// valid center with invalid corners (d_max = 0) is the second case.
///
/// @param depths    samples on the box, each finite and >= 0
/// @param epsilon_m epsilon, > 0
/// @return d_bar in (0, +inf]
[[nodiscard]] double object_depth_threshold(const BoxDepths& depths, double epsilon_m);

/// Boxes of one frame, each with its depth range. Equivalent to the mask image of the paper, without
/// rasterizing it.
class SemanticMask {
 public:
  struct MaskedBox {
    Box box;                   ///< including the margin, clipped to the image
    double threshold_m = 0.0;  ///< d_bar: upper end of the depth range of the object, exclusive; in (0, +inf]
    double near_m = 0.0;       ///< lower end, inclusive; 0 except with "depth_band"
  };

  /// An empty mask.
  SemanticMask() = default;

  /// Adds the margin of `config` to each box; ignores boxes that do not overlap the image.
  /// @param boxes without margin
  /// @param depth image of the size `size`; empty = no valid depth
  /// @param size of the image [px]
  /// @param config margin, mask shape and depth thresholds
  SemanticMask(std::span<const Box> boxes, const DepthView& depth, cv::Size size,
               const DynamicConfig& config) {
    assign(boxes, depth, size, config);
  }

  /// Same as the constructor; reuses the allocated memory.
  void assign(std::span<const Box> boxes, const DepthView& depth, cv::Size size, const DynamicConfig& config);
  void clear() { boxes_.clear(); }

  /// d_bar at a pixel [m]; the maximum where boxes overlap; 0 = no object.
  [[nodiscard]] double threshold_at(const Eigen::Vector2d& pixel) const;

  /// Whether a point at this pixel and depth belongs to an object.
  /// @param pixel in the image
  /// @param depth_m > 0
  [[nodiscard]] bool covers(const Eigen::Vector2d& pixel, double depth_m) const;

  [[nodiscard]] const std::vector<MaskedBox>& boxes() const { return boxes_; }

 private:
  std::vector<MaskedBox> boxes_;
};

}  // namespace stillpoint
