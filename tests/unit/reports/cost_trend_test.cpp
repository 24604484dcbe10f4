// SPDX-License-Identifier: BSD-3-Clause
#include "reports/cost_trend.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace stillpoint {
namespace {

/// A frame in each second; every tenth one was held up.
std::vector<FrameCost> costs(double start_ms, double slope_ms_per_min, int seconds) {
  std::vector<FrameCost> all;
  for (int i = 0; i < seconds; ++i) {
    const double t_s = i;
    const double held_up_ms = i % 10 == 3 ? 50.0 : 0.0;
    all.push_back({t_s, start_ms + slope_ms_per_min * t_s / 60.0 + held_up_ms});
  }
  return all;
}

TEST(CostTrend, FindsTheSlopeBehindFramesThatWereHeldUp) {
  const CostTrend trend = cost_trend(costs(2.0, 0.6, 300));
  EXPECT_EQ(trend.medians.size(), 30u);
  // Of the ten costs of a stretch the held-up fourth is the largest, the sixth smallest that of second 6: the
  // medians lie one second after the middle, 0.01 ms above the line, each by the same.
  EXPECT_NEAR(trend.slope_ms_per_min, 0.6, 1e-9);
  EXPECT_NEAR(trend.start_ms, 2.0 + 0.6 * 1.0 / 60.0, 1e-9);
  EXPECT_NEAR(trend.slope_interval.high - trend.slope_interval.low, 0.0, 1e-6);
}

TEST(CostTrend, KnowsNothingOfAShortRun) {
  EXPECT_NO_THROW(static_cast<void>(cost_trend(costs(2.0, 0.0, 25))));
  EXPECT_THROW(static_cast<void>(cost_trend(costs(2.0, 0.0, 20))), InputError);
}

TEST(CostTrend, IsDrawnAsADiscForEachStretch) {
  const Drawing drawing = cost_plot(cost_trend(costs(2.0, 0.0, 100)));
  int discs = 0;
  for (const Mark& mark : drawing.marks) discs += std::holds_alternative<Disc>(mark) ? 1 : 0;
  EXPECT_EQ(discs, 10);
}

}  // namespace
}  // namespace stillpoint
