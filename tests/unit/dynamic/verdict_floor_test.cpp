// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "core/dynamic/feature_recognition.h"

namespace stillpoint {
namespace {

FeatureVerdict stable(std::int64_t id) { return {.id = id}; }
FeatureVerdict mover(std::int64_t id, std::optional<double> residual_px) {
  return {.id = id,
          .verdict = Verdict::kDynamicMotion,
          .reason = VerdictReason::kResidual,
          .residual_px = residual_px};
}
FeatureVerdict masked(std::int64_t id, double residual_px) {
  return {.id = id,
          .verdict = Verdict::kDynamicObject,
          .reason = VerdictReason::kInsideMask,
          .residual_px = residual_px};
}

/// Ids that the floor made stable.
std::vector<std::int64_t> lifted(const std::vector<FeatureVerdict>& verdicts, int min_stable) {
  std::vector<std::int64_t> ids;
  for (const FeatureVerdict& verdict : apply_floor(verdicts, min_stable)) {
    if (verdict.reason != VerdictReason::kFloor) continue;
    EXPECT_EQ(verdict.verdict, Verdict::kStable);
    ids.push_back(verdict.id);
  }
  return ids;
}

using Ids = std::vector<std::int64_t>;

TEST(ApplyFloor, ChangesNothingWhereEnoughAreStable) {
  EXPECT_EQ(lifted({stable(1), stable(2), mover(3, 1.0)}, 2), Ids{});
}

TEST(ApplyFloor, LiftsTheSmallestResidualsFirst) {
  EXPECT_EQ(lifted({stable(1), mover(2, 30.0), mover(3, 12.0), mover(4, 20.0)}, 3), (Ids{3, 4}));
}

TEST(ApplyFloor, NeverLiftsWhatIsInsideTheMask) {
  EXPECT_EQ(lifted({masked(1, 0.1), mover(2, 30.0)}, 5), Ids{2});
}

TEST(ApplyFloor, LiftsWhatWasNotEvaluatedLast) {
  EXPECT_EQ(lifted({mover(1, std::nullopt), mover(2, 500.0)}, 1), Ids{2});
  EXPECT_EQ(lifted({mover(1, std::nullopt), mover(2, 500.0)}, 2), (Ids{1, 2}));
}

TEST(ApplyFloor, OfEqualResidualsTheOlderFeatureComesFirst) {
  EXPECT_EQ(lifted({mover(9, 20.0), mover(4, 20.0)}, 1), Ids{4});
}

TEST(ApplyFloor, ZeroIsNoFloor) { EXPECT_EQ(lifted({mover(1, 1.0)}, 0), Ids{}); }

}  // namespace
}  // namespace stillpoint
