// SPDX-License-Identifier: BSD-3-Clause
/// Settings of loop closure: keyframes, place recognition, verification and the pose graph. The paper names
/// loop closure (Sec. II) without describing it; the default is off. The field list explains each key.
#pragma once

#include <type_traits>

#include "core/base/fields.h"

namespace stillpoint {

struct LoopConfig {
  bool enabled = false;
  int dof = 6;
  int lag_frames = 30;

  // Keyframes
  double min_translation_m = 0.15;
  int max_corners = 500;  ///< corners besides the tracked features; not a key: the default of ORB in OpenCV
  bool exclude_dynamic = true;

  // Place recognition and verification
  double min_gap_s = 8.0;
  int min_votes = 12;    ///< features that agree with a place; not a key
  int min_inliers = 50;  ///< with fewer, loops are off by 40 to 53 mm, rendered or real

  bool final_bundle_adjustment = false;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, LoopConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("enabled", config.enabled, FieldInfo{.text = "Whether loops are closed.", .paper = "II"});
  field(
      "dof", config.dof,
      FieldInfo{
          "Degrees of freedom of a keyframe in the pose graph: 6 (position and attitude), or 4 (position and "
          "heading).",
          "", 4, 6});
  field("lag_frames", config.lag_frames,
        FieldInfo{"A correction is applied to the output this many frames after its keyframe left the "
                  "window, so that "
                  "the result does not depend on the time that the loop closure takes.",
                  "frames", 0, 1000});
  field("min_translation_m", config.min_translation_m,
        FieldInfo{"Motion since the last keyframe that makes a keyframe, besides 8 degrees of rotation.", "m",
                  0.0, 100.0});
  field("exclude_dynamic", config.exclude_dynamic,
        FieldInfo{.text = "Whether corners in the semantic mask or at dynamic features are left out."});
  field("min_gap_s", config.min_gap_s,
        FieldInfo{"Time between the two visits of a place.", "s", 0.0, 100000.0});
  field("min_inliers", config.min_inliers, FieldInfo{"Inliers that confirm a loop.", "features", 4, 10000});
  field(
      "final_bundle_adjustment", config.final_bundle_adjustment,
      FieldInfo{
          .text = "Whether all keyframes and their landmarks are adjusted after the last frame; affects the "
                  "optimized trajectory and the saved map only."});
}

}  // namespace stillpoint
