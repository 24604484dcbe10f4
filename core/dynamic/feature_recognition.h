// SPDX-License-Identifier: BSD-3-Clause
/// Which features lie on something that moves, remembered from picture to picture. Paper Sec. III-C, III-E.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/dynamic/dynamic_config.h"
#include "core/dynamic/moving_consistency.h"
#include "core/dynamic/semantic_mask.h"
#include "core/types/feature_verdict.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// The history of every feature that is tracked at present.
///
/// A feature inside the mask is dynamic. Once flagged, by the mask or by its motion, it stays so when it
/// leaves the mask or was only born there, until the consistency check clears it (Sec. III-C: "historical
/// dynamic feature"; III-E: "recycled"). The mask has the last word: nothing clears a feature inside it, so
/// a person who sits still stays out of the estimate.
///
/// Calls for each picture: `judge`, then `gate` if the prediction is checked, then `check` after the solve.
/// Each returns the verdicts of all features of the picture, by rising id; they are valid until the next
/// call.
class FeatureRecognition {
 public:
  explicit FeatureRecognition(DynamicConfig config) : config_(std::move(config)) {}

  /// Compares each feature's depth with the mask; features no longer tracked are forgotten.
  [[nodiscard]] const std::vector<FeatureVerdict>& judge(const TrackedFrame& frame, const SemanticMask& mask);

  /// Flags features that disagree with the predicted pose; clears none, since a prediction is no proof.
  [[nodiscard]] const std::vector<FeatureVerdict>& gate(std::span<const ConsistencyResidual> residuals);

  /// Flags features whose residual is over the threshold, and recycles flagged ones whose residual is not,
  /// seen often enough in the window, or that were quiet for long enough. A feature without a residual is
  /// quiet: nothing is known of its depth, and so the estimate does not use it.
  /// @param resting ids of features that stand still by now, whatever their older observations say; rising
  [[nodiscard]] const std::vector<FeatureVerdict>& check(std::span<const ConsistencyResidual> residuals,
                                                         std::span<const std::int64_t> resting = {});

  /// Forgets every feature.
  void reset() { features_.clear(); }

 private:
  struct Feature {
    FeatureVerdict verdict;
    bool inside_mask = false;
    int quiet = 0;  ///< pictures in a row, outside of the mask, in which nothing spoke for motion
  };

  [[nodiscard]] bool is_inside(const TrackedFeature& feature, const DepthView& depth,
                               const SemanticMask& mask) const;
  static void recycle(Feature& feature, VerdictReason reason = VerdictReason::kRecycled);
  void list_verdicts();

  DynamicConfig config_;
  std::vector<Feature> features_;         ///< by rising id
  std::vector<Feature> present_;          ///< the list that is being made, kept for its memory
  std::vector<FeatureVerdict> verdicts_;  ///< handed out last
};

/// Keeps suspicion from starving the estimate: where fewer than `min_stable` verdicts are stable, the dynamic
/// ones outside of the mask are made stable in order of rising residual (those without one last, then by id)
/// until there are enough. The history does not learn of it: next time they are suspect as before.
/// @param verdicts in any order; those inside the mask (`kInsideMask`) are never touched
[[nodiscard]] std::vector<FeatureVerdict> apply_floor(std::vector<FeatureVerdict> verdicts, int min_stable);

}  // namespace stillpoint
