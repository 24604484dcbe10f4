// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/cost_plots.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace stillpoint::report {
namespace {

/// One keyframe per second: 4 ms, but 900 ms for every tenth; 1 MB and 20 kB more with each further one.
std::vector<MapKeyframe> keyframes_of(int seconds) {
  std::vector<MapKeyframe> keyframes;
  for (int i = 0; i < seconds; ++i) {
    keyframes.push_back({.t = from_seconds(i),
                         .cost = {.processing_ms = i % 10 == 3 ? 900.0 : 4.0,
                                  .memory_bytes = 1'000'000 + 20'000 * static_cast<std::size_t>(i)}});
  }
  return keyframes;
}

TEST(LoopCostPlot, HasADiscAndAPointOfTheLineForEachWindow) {
  const Drawing drawing = loop_cost_plot(keyframes_of(100));
  int discs = 0;
  std::size_t longest_line = 0;
  for (const Mark& mark : drawing.marks) {
    discs += std::holds_alternative<Disc>(mark) ? 1 : 0;
    if (const auto* line = std::get_if<Polyline>(&mark))
      longest_line = std::max(longest_line, line->points.size());
  }
  EXPECT_EQ(discs, 10);
  EXPECT_EQ(longest_line, 10U);
}

TEST(LoopCostPlot, StatesTheScalesTheLongestTimeAndTheMemoryPerKeyframe) {
  // 1 MB + 99 * 20 kB = 2.98 MB.
  const std::string svg = svg_text(loop_cost_plot(keyframes_of(100)));
  EXPECT_NE(svg.find("0 to 4.0 ms; longest 900 ms"), std::string::npos) << svg;
  EXPECT_NE(svg.find("0 to 3.0 MB; 20.0 kB per keyframe"), std::string::npos) << svg;
  EXPECT_NE(svg.find("100 keyframes over 99 s"), std::string::npos) << svg;
}

TEST(LoopCostPlot, TheLineIsAtTheMemoryOfTheKeyframesBeforeTheCenterOfTheWindow) {
  // Three windows of 10 s with centers at 5, 15 and 25 s: 1.1, 1.3 and 1.5 MB of 1.58 MB after 29 s. The
  // axis is at y = 260 and the largest value at y = 60: y = 260 - 200 m / 1.58.
  const Drawing drawing = loop_cost_plot(keyframes_of(30));
  const auto* line = std::get_if<Polyline>(&drawing.marks.back());
  ASSERT_NE(line, nullptr);
  ASSERT_EQ(line->points.size(), 3U);
  EXPECT_NEAR(line->points[0].y, 260.0 - 200.0 * 1.1 / 1.58, 1e-9);
  EXPECT_NEAR(line->points[2].y, 260.0 - 200.0 * 1.5 / 1.58, 1e-9);
}

TEST(LoopCostPlot, RejectsRunsThatAreTooShort) {
  EXPECT_THROW(static_cast<void>(loop_cost_plot(keyframes_of(20))), InputError);
  EXPECT_THROW(static_cast<void>(loop_cost_plot({})), InputError);
}

}  // namespace
}  // namespace stillpoint::report
