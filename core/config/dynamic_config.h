// SPDX-License-Identifier: BSD-3-Clause
/// Settings of dynamic feature recognition. Paper Sec. III-C to III-E.
///
/// The paper gives none of the values; the defaults are those of the program, see odometry_config.h. The
/// field list explains each key, and states where the method differs from the paper.
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
  DynamicMask mask = DynamicMask::kDepthBand;  ///< keeps features in front of a person; independent of the
                                               ///< pixel at the center of the box
  double epsilon_m = 0.4;                      ///< to either side of the most frequent depth
  int depth_window_px = 5;
  double box_margin_px = 2;
  std::vector<std::string> classes = {"person", "cat", "dog", "bicycle", "car", "bus"};
  bool unmeasured_is_dynamic = false;  ///< the moving consistency check finds the dynamic ones

  // Missed detection compensation. Sec. III-D
  bool missed_detection = true;
  int max_missed_frames = 3;
  int max_skipped_frames = 10;
  double growth_px_per_miss = 3;

  // Moving consistency check. Sec. III-E
  bool moving_consistency = true;
  double mcc_threshold_px = 5;
  int mcc_min_observations = 3;
  int recycle_min_frames = 3;  ///< the window of a camera at rest spans seconds
  int min_static_frames = 3;   ///< re-admits tracks that drifted from a person onto the background
  int masked_static_frames =
      30;  ///< else a box over the whole image costs visual odometry up to 2.5 times the error
  bool gate_before_solve = true;
  double gate_probability = 0.99999;  ///< with 0.9999 a person misled it in 2 of 7 runs
  int min_stable_features = 20;
};
/// Keys of the semantic mask. Paper Sec. III-C.
template <class Visitor, class Config>
void visit_mask_fields(Visitor&& field, Config& config) {
  field("mask", config.mask,
        FieldInfo{
            .text = "Which features in a box are dynamic: those before a depth threshold, those in a band of "
                    "depths around the object (not in the paper), all, or none.",
            .paper = "III-C, Eq. (2)"});
  field("epsilon_m", config.epsilon_m,
        FieldInfo{"Epsilon of the depth threshold, or half extent of the depth band.", "m", 0.01, 100.0,
                  "III-C, Eq. (2)"});
  field(
      "depth_window_px", config.depth_window_px,
      FieldInfo{
          "Side of the window whose median is the depth of a box sample or of a feature without depth; odd.",
          "px", 1, 31, "III-C, Eq. (1)"});
  field("box_margin_px", config.box_margin_px,
        FieldInfo{"Boxes are enlarged by this on every side; not in the paper.", "px", 0.0, 500.0});
  field("classes", config.classes, FieldInfo{.text = "Classes of objects that may move.", .paper = "III-C"});
  field(
      "unmeasured_is_dynamic", config.unmeasured_is_dynamic,
      FieldInfo{
          .text = "Whether a feature without depth in a box is dynamic, as in the paper (0 < d_bar), or only "
                  "if no depth of the box is known, as in the published code.",
          .paper = "III-C"});
}

/// Keys of missed detection compensation. Paper Sec. III-D.
template <class Visitor, class Config>
void visit_missed_detection_fields(Visitor&& field, Config& config) {
  field("missed_detection", config.missed_detection,
        FieldInfo{.text = "Whether the boxes of objects that the detector misses are predicted.",
                  .paper = "III-D, Eqs. (3) to (5)"});
  field("max_missed_frames", config.max_missed_frames,
        FieldInfo{"An object is abandoned after more consecutive missed detections.", "frames", 0, 1000,
                  "III-D"});
  field("max_skipped_frames", config.max_skipped_frames,
        FieldInfo{
            "An object is abandoned after more frames without a message of the detector; not in the paper.",
            "frames", 0, 1000});
  field("growth_px_per_miss", config.growth_px_per_miss,
        FieldInfo{"Growth of a predicted box on every side per frame without a detection; 0 in the paper.",
                  "px", 0.0, 500.0});
}

/// Keys of the moving consistency check. Paper Sec. III-E.
template <class Visitor, class Config>
void visit_consistency_fields(Visitor&& field, Config& config) {
  field("moving_consistency", config.moving_consistency,
        FieldInfo{.text = "Whether features that contradict the estimated poses are labeled dynamic.",
                  .paper = "III-E"});
  field("mcc_threshold_px", config.mcc_threshold_px,
        FieldInfo{
            "A feature whose mean residual r_k in the window is larger is dynamic; px at the focal length.",
            "px", 0.1, 1000.0, "III-E, Eq. (6)"});
  field(
      "mcc_min_observations", config.mcc_min_observations,
      FieldInfo{
          "Observations in the window that recycle a dynamic feature with a small r_k; the paper: \"more\".",
          "frames", 2, 40, "III-E"});
  field(
      "recycle_min_frames", config.recycle_min_frames,
      FieldInfo{
          "A dynamic feature is also recycled after this many consecutive frames with r_k below 1 px, as the "
          "frames of the window may span seconds; 0 = never; not in the paper.",
          "frames", 0, 1000});
  field("min_static_frames", config.min_static_frames,
        FieldInfo{
            "A dynamic feature is readmitted, without its older observations, after this many consecutive "
            "frames at one place of the world; 0 = never; not in the paper.",
            "frames", 0, 1000});
  field("masked_static_frames", config.masked_static_frames,
        FieldInfo{"A feature inside the mask counts as static after this many consecutive residuals r_k "
                  "below 1 px, and is "
                  "used while few others are stable; 0 = never; not in the paper.",
                  "frames", 0, 1000});
  field(
      "gate_before_solve", config.gate_before_solve,
      FieldInfo{
          .text = "Whether the newest frame is also checked at its predicted pose, before the solve; in the "
                  "paper, but not in the published code.",
          .paper = "III-E"});
  field("gate_probability", config.gate_probability,
        FieldInfo{"Probability that a static feature passes the check at the predicted pose, by the "
                  "covariance of the "
                  "prediction; 0, or without a covariance: a residual of at most 10 px; not in the paper.",
                  "", 0.0, 0.999999});
  field("min_stable_features", config.min_stable_features,
        FieldInfo{
            "Features that are left at least, unless inertial data predicts the pose with its covariance; "
            "not in the paper.",
            "features", 0, 1000});
}

template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, DynamicConfig>
void visit_fields(Visitor&& field, Config& config) {
  visit_mask_fields(field, config);
  visit_missed_detection_fields(field, config);
  visit_consistency_fields(field, config);
}

}  // namespace stillpoint
