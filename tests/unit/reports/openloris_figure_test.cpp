// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/openloris_figure.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reports/drawing/drawing.h"
#include "reports/text/evaluation_report.h"

namespace stillpoint::report {
namespace {

/// Two sequences of 10 s; the only system has correct poses in the second one, from 2 s to 6 s.
eval::OpenlorisBenchmark small_benchmark() {
  eval::OpenlorisBenchmark benchmark;
  benchmark.gt_durations_s["cafe"] = {{1, 10.0}, {2, 10.0}};
  eval::OpenlorisScene& scene = benchmark.systems["dso"]["cafe"];
  eval::OpenlorisSequenceScore& run = scene.runs[2].score;
  run.correct = 1;
  run.correct_time_s = 4.0;
  run.tracked_time_s = 8.0;
  run.tracked_rate = 0.5;
  run.correct_ate_rmse_m = 0.25;
  run.relocalization_time_s = 2.0;
  run.relocalization_score = 0.9;
  run.tracked_spans = {{2.0, 6.0}};
  scene.score = eval::score_openloris_scene(scene.runs, benchmark.gt_durations_s["cafe"]);
  return benchmark;
}

bool has_label(const Drawing& drawing, const std::string& text) {
  return std::any_of(drawing.marks.begin(), drawing.marks.end(), [&](const Mark& mark) {
    const Label* const label = std::get_if<Label>(&mark);
    return label != nullptr && label->text == text;
  });
}

TEST(OpenlorisFigure, ShowsRatesAndMissingData) {
  const Drawing figure = openloris_figure(small_benchmark());
  EXPECT_TRUE(has_label(figure, "cafe (20 s)"));
  EXPECT_TRUE(has_label(figure, "20.0%"));  // 4 s of 20 s, including the sequence without a result
  EXPECT_TRUE(has_label(figure, "0.250"));
  EXPECT_TRUE(has_label(figure, "-  -"));  // no RPE: never 0
  EXPECT_TRUE(has_label(figure, "DSO"));
}

// A scene of which a system has no run at all has no rate: 0 % is that of runs that failed.
TEST(OpenlorisFigure, HasNoRateWithoutARun) {
  eval::OpenlorisBenchmark benchmark = small_benchmark();
  benchmark.gt_durations_s["home"] = {{1, 10.0}};
  benchmark.systems["dso"]["home"].score = eval::score_openloris_scene({}, benchmark.gt_durations_s["home"]);
  EXPECT_FALSE(has_label(openloris_figure(benchmark), "0.0%"));
  benchmark.systems["dso"]["home"].runs[1];
  EXPECT_TRUE(has_label(openloris_figure(benchmark), "0.0%"));
}

TEST(OpenlorisFigure, KeepsALongHeadingInsideItsPanel) {
  eval::OpenlorisBenchmark benchmark = small_benchmark();
  const std::string scene = "cafe + " + std::string(200, 'x');
  benchmark.gt_durations_s[scene] = {{1, 10.0}};
  benchmark.systems["dso"][scene] = {};
  const Drawing figure = openloris_figure(benchmark);
  for (const Mark& mark : figure.marks) {
    const Label* const label = std::get_if<Label>(&mark);
    if (label == nullptr || !label->text.starts_with(scene)) continue;
    EXPECT_LE(label->at.x + 0.5 * text_width(label->text, label->size), figure.width);
    return;
  }
  FAIL() << "no heading";
}

TEST(OpenlorisFigure, DrawsATrackedSpanAtItsTime) {
  const Drawing figure = openloris_figure(small_benchmark());
  std::vector<Polyline> bars;
  std::vector<Disc> starts;
  for (const Mark& mark : figure.marks) {
    if (const Polyline* const line = std::get_if<Polyline>(&mark); line != nullptr && line->width == 7.0) {
      bars.push_back(*line);
    }
    if (const Disc* const disc = std::get_if<Disc>(&mark); disc != nullptr && disc->color.blue < 100) {
      starts.push_back(*disc);
    }
  }
  ASSERT_EQ(bars.size(), 1u);
  ASSERT_EQ(starts.size(), 2u);  // the black dots: sequence starts at 0 s and 10 s
  const double units_per_s = (starts[1].center.x - starts[0].center.x) / 10.0;
  EXPECT_NEAR(bars[0].points[0].x, starts[1].center.x + 2.0 * units_per_s, 1e-9);
  EXPECT_NEAR(bars[0].points[1].x, starts[1].center.x + 6.0 * units_per_s, 1e-9);
}

TEST(OpenlorisTable, HasAColumnForEachRateAndError) {
  const std::string csv = openloris_table(small_benchmark(), TableStyle::kCsv);
  EXPECT_NE(csv.find("dso,cafe,1/2,20.0,50.0,0.2500,0.2500,n/a,n/a,0,0\n"), std::string::npos) << csv;
}

}  // namespace
}  // namespace stillpoint::report
