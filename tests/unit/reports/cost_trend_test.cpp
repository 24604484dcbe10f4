// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/cost_plots.h"

#include <cmath>

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
  EXPECT_NEAR(trend.slope_interval->high - trend.slope_interval->low, 0.0, 1e-6);
}

/// One cost per window of 10 s.
CostTrend trend_of_windows(const std::vector<double>& ms) {
  std::vector<FrameCost> all;
  for (std::size_t i = 0; i < ms.size(); ++i) all.push_back({10.0 * static_cast<double>(i) + 5.0, ms[i]});
  return cost_trend(all);
}

TEST(CostTrend, IntervalAccountsForTheNumberOfWindows) {
  // Residuals 1, -1, 0, -1, 1 have no slope: their sum of squares is 4, S_tt = 100 (4 + 1 + 1 + 4) = 1000,
  // and the quantile for 3 degrees of freedom is 3.182 (tables of Student's t), not 1.96.
  const CostTrend trend = trend_of_windows({6.0, 4.0, 5.0, 4.0, 6.0});
  EXPECT_NEAR(trend.slope_interval->high, 60.0 * 3.182 * std::sqrt(4.0 / 3.0 / 1000.0), 0.01);
}

TEST(CostTrend, HasNoIntervalForFewerThanFiveWindows) {
  const CostTrend trend = trend_of_windows({6.0, 4.0, 5.0, 4.0});
  EXPECT_FALSE(trend.slope_interval);
  const std::string svg = svg_text(cost_plot(trend));
  EXPECT_NE(svg.find("n = 4, no interval"), std::string::npos) << svg;
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
