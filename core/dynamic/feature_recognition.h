// SPDX-License-Identifier: BSD-3-Clause
/// Recognition of features on dynamic objects, with a label history per feature. Paper Sec. III-C, III-E.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/config/dynamic_config.h"
#include "core/dynamic/moving_consistency.h"
#include "core/dynamic/semantic_mask.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// Labels of all currently tracked features.
///
/// A feature inside the mask is dynamic. A feature labeled dynamic, by the mask or by its motion, remains
/// dynamic after it leaves the mask until the consistency check recycles it (Sec. III-C: "historical dynamic
/// feature"; III-E: "recycled"). A feature inside the mask is not recycled, so that a sitting person
/// remains excluded from the estimate.
///
/// Not in the paper: with `masked_static_frames` = n > 0, features inside the mask with r_k <= 1 px in their
/// last n residuals are relabeled as stable, the oldest first, while less than two thirds of all features
/// are stable, so that a wrong box over much of the image costs little. While the mask excludes a feature,
/// the poses do not depend on it, and its residuals are independent evidence. The label history is not
/// affected.
///
/// Call order for each frame: `classify`, `gate` if the predicted pose is checked, `check` after the solve.
/// Each returns the labels of all features of the frame, by ascending id, valid until the next call.
class FeatureRecognition {
 public:
  explicit FeatureRecognition(DynamicConfig config) : config_(std::move(config)) {}

  /// Compares the depth of each feature with the mask; removes features that are no longer tracked.
  [[nodiscard]] const std::vector<DynamicLabel>& classify(const TrackedFrame& frame,
                                                          const SemanticMask& mask);

  /// Labels features with a residual above 10 px, or outside the gate of `gate_probability`, as
  /// dynamic. Recycles none: the residuals are computed at the predicted pose. With squared distances, that
  /// is, a covariance of the prediction, no minimum of features is kept, neither here nor by `check` of the
  /// frame: behind a person who comes in front of the camera those that fit best are on the person, and
  /// inertial data locates the frame without them.
  [[nodiscard]] const std::vector<DynamicLabel>& gate(std::span<const ConsistencyResidual> residuals);

  /// Labels features with a residual r_k above `mcc_threshold_px` as dynamic. Recycles dynamic features
  ///   - with r_k at or below the threshold and at least `mcc_min_observations` observations,
  ///   - with r_k <= 1 px in `recycle_min_frames` consecutive frames; a frame without a
  ///     residual counts, since a feature without depth does not enter the estimate,
  ///   - listed in `readmitted`.
  /// @param readmitted ids from StaticReadmission, ascending
  [[nodiscard]] const std::vector<DynamicLabel>& check(std::span<const ConsistencyResidual> residuals,
                                                       std::span<const std::int64_t> readmitted = {});

  /// Removes all features.
  void reset() { features_.clear(); }

 private:
  struct Feature {
    DynamicLabel label;
    bool inside_mask = false;
    int static_frames = 0;     ///< consecutive, outside the mask, with r_k <= 1 px or without r_k
    int static_residuals = 0;  ///< consecutive residuals r_k <= 1 px, inside or outside the mask
  };

  [[nodiscard]] bool is_inside(const TrackedFeature& feature, const DepthView& depth,
                               const SemanticMask& mask) const;
  static void recycle(Feature& feature, LabelReason reason = LabelReason::kRecycled);
  void collect_labels();
  void readmit_masked();

  DynamicConfig config_;
  std::vector<Feature> features_;       ///< by ascending id
  std::vector<Feature> next_features_;  ///< scratch of `classify`
  std::vector<DynamicLabel> labels_;    ///< last result
  bool is_predicted_ = false;           ///< the frame, with a covariance, by inertial data
};

/// Guarantees a minimum number of features for the estimate: if fewer than `min_stable` labels are stable,
/// dynamic features outside the mask are relabeled stable in order of ascending residual (features without a
/// residual last, ties by id) until there are enough. The label history is not affected.
/// @param labels in any order; labels with reason `kInsideMask` are not changed
[[nodiscard]] std::vector<DynamicLabel> enforce_min_stable(std::vector<DynamicLabel> labels, int min_stable);

}  // namespace stillpoint
