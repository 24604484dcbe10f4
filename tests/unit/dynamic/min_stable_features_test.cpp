// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "core/dynamic/feature_recognition.h"

namespace stillpoint {
namespace {

DynamicLabel stable(std::int64_t id) { return {.id = id}; }
DynamicLabel moving(std::int64_t id, std::optional<double> residual_px) {
  return {.id = id,
          .label = LabelClass::kDynamicMotion,
          .reason = LabelReason::kResidual,
          .residual_px = residual_px};
}
DynamicLabel masked(std::int64_t id, double residual_px) {
  return {.id = id,
          .label = LabelClass::kDynamicObject,
          .reason = LabelReason::kInsideMask,
          .residual_px = residual_px};
}

/// Ids relabeled as stable.
std::vector<std::int64_t> relabeled(const std::vector<DynamicLabel>& labels, int min_stable) {
  std::vector<std::int64_t> ids;
  for (const DynamicLabel& label : enforce_min_stable(labels, min_stable)) {
    if (label.reason != LabelReason::kMinimumKept) continue;
    EXPECT_EQ(label.label, LabelClass::kStable);
    ids.push_back(label.id);
  }
  return ids;
}

using Ids = std::vector<std::int64_t>;

TEST(EnforceMinStable, ChangesNothingIfEnoughFeaturesAreStable) {
  EXPECT_EQ(relabeled({stable(1), stable(2), moving(3, 1.0)}, 2), Ids{});
}

TEST(EnforceMinStable, RelabelsTheSmallestResidualsFirst) {
  EXPECT_EQ(relabeled({stable(1), moving(2, 30.0), moving(3, 12.0), moving(4, 20.0)}, 3), (Ids{3, 4}));
}

TEST(EnforceMinStable, NeverRelabelsFeaturesInsideTheMask) {
  EXPECT_EQ(relabeled({masked(1, 0.1), moving(2, 30.0)}, 5), Ids{2});
}

TEST(EnforceMinStable, RelabelsFeaturesWithoutResidualLast) {
  EXPECT_EQ(relabeled({moving(1, std::nullopt), moving(2, 500.0)}, 1), Ids{2});
  EXPECT_EQ(relabeled({moving(1, std::nullopt), moving(2, 500.0)}, 2), (Ids{1, 2}));
}

TEST(EnforceMinStable, ResolvesTiesByTheLowerId) {
  EXPECT_EQ(relabeled({moving(9, 20.0), moving(4, 20.0)}, 1), Ids{4});
}

TEST(EnforceMinStable, ZeroDisablesTheMinimum) { EXPECT_EQ(relabeled({moving(1, 1.0)}, 0), Ids{}); }

}  // namespace
}  // namespace stillpoint
