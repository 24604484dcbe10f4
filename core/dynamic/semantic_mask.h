// SPDX-License-Identifier: BSD-3-Clause
/// Depth-aware masks for detected objects. Paper Sec. III-C, Eqs. (1)-(2).
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "core/dynamic/depth_view.h"
#include "core/dynamic/dynamic_config.h"
#include "core/types/detection.h"

namespace stillpoint {

/// Depths sampled on one detection box [m]; 0 means "not measured".
struct BoxDepths {
  std::array<double, 4> corners{};  ///< top-left, top-right, bottom-left, bottom-right
  double center = 0.0;
};

/// Depth below which a feature inside the box belongs to the object [m].
///
/// @param depths    samples on the box, each finite and >= 0
/// @param epsilon_m typical depth extent of a dynamic object [m], > 0
/// @return threshold in (0, +inf]; +inf when nothing was measured
///
/// Read to the letter, Eq. (2) sends `d_max - d_c == epsilon` to +inf; here it falls to the second case. A
/// measured centre before unmeasured corners (d_max = 0) satisfies the second case as it stands.
[[nodiscard]] double object_depth_threshold(const BoxDepths& depths, double epsilon_m);

/// The boxes of one picture, each with its depth threshold: the paper's mask picture, never drawn.
class SemanticMask {
 public:
  struct MaskedBox {
    Box box;                   ///< margin included, ends at the picture's edges
    double threshold_m = 0.0;  ///< nearer features belong to the object; in (0, +inf]
    double near_m = 0.0;       ///< but not those nearer than this: they stand before it
  };

  /// The mask without objects.
  SemanticMask() = default;

  /// Takes up boxes with the margin of `config`; those without area in the picture are left out.
  /// @param depth picture of the size `size`; empty = nothing measured
  SemanticMask(std::span<const Box> boxes, const DepthView& depth, cv::Size size,
               const DynamicConfig& config) {
    assign(boxes, depth, size, config);
  }

  /// The same as constructing anew, in the memory that is there.
  void assign(std::span<const Box> boxes, const DepthView& depth, cv::Size size, const DynamicConfig& config);
  /// Forgets every box.
  void clear() { boxes_.clear(); }

  /// Threshold at a pixel [m]; the largest where boxes overlap; 0 = no object.
  [[nodiscard]] double threshold_at(const Eigen::Vector2d& pixel) const;

  /// Whether a point at this pixel and depth belongs to an object.
  /// @param depth_m > 0
  [[nodiscard]] bool covers(const Eigen::Vector2d& pixel, double depth_m) const;

  [[nodiscard]] const std::vector<MaskedBox>& boxes() const { return boxes_; }

 private:
  std::vector<MaskedBox> boxes_;
};

}  // namespace stillpoint
