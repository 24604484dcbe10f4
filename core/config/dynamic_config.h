// SPDX-License-Identifier: BSD-3-Clause
/// Settings of dynamic feature recognition. Paper Sec. III-C to III-E.
///
/// The paper gives none of the values; the defaults are those of the published Dynamic-VINS code. Comments
/// state where the method differs from the paper.
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "core/base/fields.h"

namespace stillpoint {

/// Which features inside a detected box are dynamic; see semantic_mask.h.
enum class DynamicMask { kDepthThreshold, kDepthBand, kWholeBox, kOff };
constexpr auto enum_names(DynamicMask) {
  return EnumNames<DynamicMask, 4>{{{DynamicMask::kDepthThreshold, "depth_threshold"},
                                    {DynamicMask::kDepthBand, "depth_band"},
                                    {DynamicMask::kWholeBox, "whole_box"},
                                    {DynamicMask::kOff, "off"}}};
}

struct DynamicConfig {
  // Mask. Sec. III-C
  DynamicMask mask = DynamicMask::kDepthThreshold;  ///< Eq. (2), or an alternative to it
  double epsilon_m = 1.0;     ///< epsilon of Eq. (2), or half extent of the depth band [m]
  int depth_window_px = 1;    ///< side of the median window for depth samples on the box, and for features
                              ///< without depth; odd
  double box_margin_px = 10;  ///< boxes are enlarged by it on every side; not in the paper
  std::vector<std::string> classes = {"person", "cat", "dog", "bicycle", "car", "bus"};  ///< dynamic classes
  /// Whether a feature with invalid depth inside a box is dynamic. True follows Sec. III-C: 0 < d_bar. False
  /// follows the published code: dynamic only if d_bar is infinite.
  bool unmeasured_is_dynamic = true;

  // Missed detection compensation. Sec. III-D
  bool missed_detection = true;
  int max_missed_frames = 3;       ///< an object is abandoned after more consecutive missed detections
  int max_skipped_frames = 10;     ///< same for frames without detector output; not in the paper
  double growth_px_per_miss = 10;  ///< growth of a predicted box per frame, on every side; 0 in the paper
  double min_iou = 0.3;            ///< minimum overlap for data association; not in the paper

  // Moving consistency check. Sec. III-E
  bool moving_consistency = true;
  double mcc_threshold_px = 10;  ///< r_k of Eq. (6) above which a feature is dynamic, px of the focal length
  int mcc_min_observations = 2;  ///< in the window, required to recycle a feature; the paper: "more"
  int recycle_min_frames = 0;  ///< also recycle after so many consecutive frames with a small r_k, since the
                               ///< frames of the window may span seconds; 0 = never; not in the paper
  double recycle_residual_px = 1;  ///< largest r_k of these frames
  int min_static_frames = 0;  ///< readmit a feature after so many consecutive static frames and discard its
                              ///< older observations; 0 = never; not in the paper
  double static_residual_px = 1;   ///< largest reprojection error of these frames, px of the focal length
  bool gate_before_solve = false;  ///< also check the newest frame at its predicted pose before the solve. In
                                   ///< the paper, but not in the published code
  double gate_threshold_px = 10;   ///< residual at the predicted pose above which a feature is dynamic
  /// Instead of the threshold, the probability that a static feature passes the check at the predicted pose,
  /// by the covariance of the prediction; 0 = the threshold, as without a covariance. Not in the paper
  double gate_probability = 0;
  int min_stable_features = 0;  ///< minimum number of features left by the check; not in the paper
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, DynamicConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("mask", config.mask);
  field("epsilon_m", config.epsilon_m, 0.01, 100.0);
  field("depth_window_px", config.depth_window_px, 1, 31);
  field("box_margin_px", config.box_margin_px, 0.0, 500.0);
  field("classes", config.classes);
  field("unmeasured_is_dynamic", config.unmeasured_is_dynamic);
  field("missed_detection", config.missed_detection);
  field("max_missed_frames", config.max_missed_frames, 0, 1000);
  field("max_skipped_frames", config.max_skipped_frames, 0, 1000);
  field("growth_px_per_miss", config.growth_px_per_miss, 0.0, 500.0);
  field("min_iou", config.min_iou, 0.01, 1.0);
  field("moving_consistency", config.moving_consistency);
  field("mcc_threshold_px", config.mcc_threshold_px, 0.1, 1000.0);
  field("mcc_min_observations", config.mcc_min_observations, 2, 40);
  field("recycle_min_frames", config.recycle_min_frames, 0, 1000);
  field("recycle_residual_px", config.recycle_residual_px, 0.01, 1000.0);
  field("min_static_frames", config.min_static_frames, 0, 1000);
  field("static_residual_px", config.static_residual_px, 0.01, 1000.0);
  field("gate_before_solve", config.gate_before_solve);
  field("gate_threshold_px", config.gate_threshold_px, 0.1, 1000.0);
  field("gate_probability", config.gate_probability, 0.0, 0.999999);
  field("min_stable_features", config.min_stable_features, 0, 1000);
}

}  // namespace stillpoint
