// SPDX-License-Identifier: BSD-3-Clause
/// Settings of the recognition of dynamic features. Paper Sec. III-C to III-E; defaults are Dynamic-VINS'.
///
/// The paper gives none of the values; they are those of the published code. Where both differ in kind, the
/// comment says so.
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "core/base/fields.h"

namespace stillpoint {

/// Which part of a detected box is the object.
enum class DynamicMask { kDepthThreshold, kDepthBand, kWholeBox, kOff };
constexpr auto enum_names(DynamicMask) {
  return EnumNames<DynamicMask, 4>{{{DynamicMask::kDepthThreshold, "depth_threshold"},
                                    {DynamicMask::kDepthBand, "depth_band"},
                                    {DynamicMask::kWholeBox, "whole_box"},
                                    {DynamicMask::kOff, "off"}}};
}

struct DynamicConfig {
  DynamicMask mask = DynamicMask::kDepthThreshold;  ///< Eq. (2), the object's most frequent depths, the whole
                                                    ///< box, or no masks
  double epsilon_m = 1.0;   ///< depth extent of a dynamic object [m], epsilon of Eq. (2)
  int depth_window_px = 1;  ///< side of the window whose median is read as depth, also of a feature that has
                            ///< none of its own; odd, 1 = one pixel
  double box_margin_px = 10;  ///< boxes are taken this much larger on every side; not in the paper
  std::vector<std::string> classes = {"person", "cat", "dog", "bicycle", "car", "bus"};  ///< that may move
  /// A feature without depth inside a box is dynamic: Sec. III-C to the letter, since 0 < threshold. The
  /// published code asks for depth unless the threshold is infinite; so does false.
  bool unmeasured_is_dynamic = true;

  bool missed_detection = true;    ///< carry boxes over missed detections. Sec. III-D
  int max_missed_frames = 3;       ///< looked for and not found so often in a row: the object is given up
  int max_unwatched_frames = 10;   ///< the same for pictures in which no detector looked; own choice
  double growth_px_per_miss = 10;  ///< a carried box grows so much a picture, each side; paper 0
  double min_iou = 0.3;            ///< overlap that makes two boxes one object; own choice

  bool moving_consistency = true;  ///< Eq. (6) over the window. Sec. III-E
  double mcc_threshold_px = 10;    ///< mean residual of a mover, px of the camera's focal length
  int mcc_min_observations = 2;    ///< that must agree before a feature is recycled; the paper: "more"
  int quiet_pictures = 0;  ///< recycles also after so many in a row; 0 = only by the window, whose pictures
                           ///< may lie far apart; own addition
  double quiet_px = 1;     ///< mean residual up to which a picture counts as quiet
  int rest_pictures = 0;   ///< a feature that stayed at one place for so many pictures is still from then on,
                           ///< and its older observations are dropped; 0 = never; own addition
  double rest_px = 1;      ///< that count as staying, px of the camera's focal length
  bool gate_before_solve = false;  ///< check the newest picture at its predicted pose first; the paper
                                   ///< names that pose, the published code only uses optimised ones
  double gate_threshold_px = 10;   ///< mean residual of a mover there, px of the camera's focal length
  int min_stable_features = 0;     ///< the consistency check leaves at least so many; own addition
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
  field("max_unwatched_frames", config.max_unwatched_frames, 0, 1000);
  field("growth_px_per_miss", config.growth_px_per_miss, 0.0, 500.0);
  field("min_iou", config.min_iou, 0.01, 1.0);
  field("moving_consistency", config.moving_consistency);
  field("mcc_threshold_px", config.mcc_threshold_px, 0.1, 1000.0);
  field("mcc_min_observations", config.mcc_min_observations, 2, 40);
  field("quiet_pictures", config.quiet_pictures, 0, 1000);
  field("quiet_px", config.quiet_px, 0.01, 1000.0);
  field("rest_pictures", config.rest_pictures, 0, 1000);
  field("rest_px", config.rest_px, 0.01, 1000.0);
  field("gate_before_solve", config.gate_before_solve);
  field("gate_threshold_px", config.gate_threshold_px, 0.1, 1000.0);
  field("min_stable_features", config.min_stable_features, 0, 1000);
}

}  // namespace stillpoint
