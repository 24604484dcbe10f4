// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/cost_trend.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace stillpoint::report {
namespace {

/// One frame per second; every tenth is delayed.
std::vector<FrameCost> costs(double start_ms, double slope_ms_per_min, int seconds) {
  std::vector<FrameCost> all;
  for (int i = 0; i < seconds; ++i) {
    const double t_s = i;
    const double delay_ms = i % 10 == 3 ? 50.0 : 0.0;
    all.push_back({t_s, start_ms + slope_ms_per_min * t_s / 60.0 + delay_ms});
  }
  return all;
}

TEST(CostTrend, SlopeIgnoresDelayedFrames) {
  const CostTrend trend = cost_trend(costs(2.0, 0.6, 300));
  EXPECT_EQ(trend.medians.size(), 30u);
  // Of the ten costs of a window the delayed fourth is the largest, and the sixth smallest (the median used)
  // is that of second 6: every median lies one second after the window's center, 0.01 ms above the line.
  EXPECT_NEAR(trend.slope_ms_per_min, 0.6, 1e-9);
  EXPECT_NEAR(trend.start_ms, 2.0 + 0.6 * 1.0 / 60.0, 1e-9);
  EXPECT_NEAR(trend.slope_interval.high - trend.slope_interval.low, 0.0, 1e-6);
}

TEST(CostTrend, RejectsRunsThatAreTooShort) {
  EXPECT_NO_THROW(static_cast<void>(cost_trend(costs(2.0, 0.0, 25))));
  EXPECT_THROW(static_cast<void>(cost_trend(costs(2.0, 0.0, 20))), InputError);
}

TEST(CostTrend, PlotHasADiscForEachWindow) {
  const Drawing drawing = cost_plot(cost_trend(costs(2.0, 0.0, 100)));
  int discs = 0;
  for (const Mark& mark : drawing.marks) discs += std::holds_alternative<Disc>(mark) ? 1 : 0;
  EXPECT_EQ(discs, 10);
}

}  // namespace
}  // namespace stillpoint::report
