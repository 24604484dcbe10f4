// SPDX-License-Identifier: BSD-3-Clause
/// Segmentation-like masks from boxes and depth. Paper Sec. III-C, Eqs. (1)-(2).
///
/// A feature at pixel u with depth d is dynamic if u lies in the box of an object and d < d_bar, Eq. (2).
///
/// `dynamic.mask` selects how the depth range of an object is computed:
///   "depth_threshold"  Eq. (2), the default of DynamicConfig: bench/configs/dynamic_vins.toml and
///                      dynamic_vins_vo.toml
///   "depth_band"       object_depth_band.h, not in the paper: bench/configs/stillpoint.toml (the default
///                      configuration of the program) and the overlay ablations/depth_band.toml
///   "whole_box"        d_bar = +inf: the overlay ablations/wo_seg_like_mask.toml
///   "off"              no mask: baselines/vins_rgbd.toml and baselines/vins_mono.toml
/// All other files in bench/configs/ are overlays that do not change the mask.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "core/config/dynamic_config.h"
#include "core/dynamic/depth_view.h"
#include "core/types/detection.h"

namespace stillpoint {

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
