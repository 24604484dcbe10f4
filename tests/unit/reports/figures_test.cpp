// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/evaluation/figures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>

#include "datasets/mapping/occupancy_grid.h"
#include "eval/io/nmea_file.h"
#include "reports/drawing/curves.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/reports/circle_runs.h"

namespace stillpoint::report {
namespace {

std::vector<Polyline> lines_of(const Drawing& drawing, const Color& color, double width) {
  std::vector<Polyline> lines;
  for (const Mark& mark : drawing.marks) {
    const auto* const line = std::get_if<Polyline>(&mark);
    if (line == nullptr || line->width != width || line->points.size() < 3) continue;
    if (line->color.red == color.red && line->color.green == color.green && line->color.blue == color.blue)
      lines.push_back(*line);
  }
  return lines;
}

TEST(NiceTicks, AreFewRoundNumbersInTheRange) {
  const Ticks ticks = nice_ticks({-0.13, 0.87}, 6);
  EXPECT_DOUBLE_EQ(ticks.step, 0.2);
  ASSERT_EQ(ticks.values.size(), 5U);  // 0, 0.2, ..., 0.8
  EXPECT_NEAR(ticks.values.front(), 0.0, 1e-12);
  EXPECT_NEAR(ticks.values.back(), 0.8, 1e-12);
  EXPECT_EQ(nice_ticks({0.0, 10.0}, 11).values.size(), 11U);  // the ends of the range are in it
  EXPECT_EQ(nice_ticks({0.0, 10.0}, 10).step, 2.0);
}

TEST(TickText, HasTheDecimalsOfTheStep) {
  EXPECT_EQ(tick_text(0.4, 0.2), "0.4");
  EXPECT_EQ(tick_text(1.0, 0.05), "1.00");
  EXPECT_EQ(tick_text(-20.0, 10.0), "\u221220");
  EXPECT_EQ(tick_text(-1e-17, 0.2), "0.0");
}

TEST(ShortNumber, HasThreeSignificantDigits) {
  EXPECT_EQ(short_number(0.01234), "0.0123");
  EXPECT_EQ(short_number(12.34), "12.3");
  EXPECT_EQ(short_number(1234.5), "1234");
  EXPECT_EQ(short_number(0.0), "0");
}

TEST(ScaleBar, HasARoundLength) {
  EXPECT_DOUBLE_EQ(scale_bar_m(100.0), 20.0);
  EXPECT_DOUBLE_EQ(scale_bar_m(160.0), 50.0);
  EXPECT_DOUBLE_EQ(scale_bar_m(4.0), 1.0);
  EXPECT_DOUBLE_EQ(scale_bar_m(0.5), 0.1);
}

TEST(SplitAtGaps, SplitsWherePosesAreMissing) {
  std::vector<CurvePoint> points;
  for (const double t : {0.0, 0.1, 0.2, 0.9, 1.5, 1.6}) points.push_back({t, {t, t}});
  // The median interval is 0.1 s; 0.7 and 0.6 s are more than five of these.
  const Curve curve = split_at_gaps(points);
  ASSERT_EQ(curve.size(), 3U);
  EXPECT_EQ(curve[1].size(), 1U);
}

TEST(SplitAtGaps, SplitsAtJumpsAndLeavesOutWhatIsNotDetermined) {
  const std::vector<CurvePoint> points{
      {0.0, {0.0, 179.0}}, {1.0, {1.0, -179.0}}, {2.0, {2.0, std::nan("")}}, {3.0, {3.0, 0.0}}};
  const Curve curve = split_at_gaps(points, 180.0);
  ASSERT_EQ(curve.size(), 3U);
  EXPECT_EQ(curve[2].front().t_s, 3.0);
}

TEST(Thinned, KeepsPeaksOfAColumn) {
  std::vector<Point2> line;
  for (int i = 0; i < 1000; ++i) line.push_back({1e-4 * i, i == 500 ? 9.0 : 0.0});
  const std::vector<Point2> kept = thinned(line);
  EXPECT_LE(kept.size(), 4U);
  EXPECT_TRUE(std::ranges::any_of(kept, [](const Point2& p) { return p.y == 9.0; }));
}

TEST(PathFigure, HasEqualScalesAndGaps) {
  const CircleRuns circles;
  const Drawing drawing = figure(FigureKind::kPath, circles.both(), {});
  const std::vector<Polyline> truth = lines_of(drawing, theme::kBlack, theme::kTruthWidth);
  ASSERT_EQ(truth.size(), 2U);  // plan and side view
  const auto [left, right] = std::ranges::minmax(truth[0].points, {}, &Point2::x);
  const auto [top, bottom] = std::ranges::minmax(truth[0].points, {}, &Point2::y);
  EXPECT_NEAR(right.x - left.x, bottom.y - top.y, 0.3);  // a circle is round
  // Two parts in each view.
  EXPECT_EQ(lines_of(drawing, theme::kEstimates[0].color, theme::kEstimateWidth).size(), 4U);
}

TEST(PathFigure, DrawsTheTruthDashedAboveTheEstimates) {
  const CircleRuns circles;
  const Drawing drawing = figure(FigureKind::kPath, circles.both(), {});
  long estimates = 0;  // in the plan view, before the truth
  for (const Mark& mark : drawing.marks) {
    const auto* const line = std::get_if<Polyline>(&mark);
    if (line == nullptr || line->points.size() < 20) continue;
    if (line->width == theme::kEstimateWidth) ++estimates;
    if (line->width != theme::kTruthWidth) continue;
    EXPECT_FALSE(line->dashes.empty());
    break;
  }
  EXPECT_EQ(estimates, 4);  // two of each
}

TEST(PathFigure, ColorsASingleEstimateByItsError) {
  const CircleRuns circles;
  const Drawing drawing = figure(FigureKind::kPath, circles.one(), {});
  std::vector<int> reds;
  for (const Mark& mark : drawing.marks) {
    const auto* const line = std::get_if<Polyline>(&mark);
    if (line != nullptr && line->width == theme::kColoredWidth)
      reds.push_back(line->color.red * 256 + line->color.blue);
  }
  std::ranges::sort(reds);
  reds.erase(std::unique(reds.begin(), reds.end()), reds.end());
  EXPECT_GT(reds.size(), 10U);
  EXPECT_NE(svg_text(drawing).find(">position error [m]</text>"), std::string::npos);  // of the color bar
}

/// What begins a file of the format, and what is in it.
struct FormatMark {
  const char* extension;
  const char* beginning;
  const char* content;
};

TEST(Figures, AreDrawnInFourFormatsWithTheirFonts) {
  const CircleRuns circles;
  const TemporaryFolder folder;
  for (const auto& [kind, name] : enum_names(FigureKind{})) {
    const std::array<Drawing, 1> drawings{figure(kind, circles.both(), {})};
    for (const FormatMark& format :
         {FormatMark{"pdf", "%PDF-", "/FontFile"}, FormatMark{"svg", "<", "near</text>"},
          FormatMark{"png", "\x89PNG", "IDAT"}, FormatMark{"html", "<!doctype html>", "near</text>"}}) {
      const std::filesystem::path file = folder.path() / (std::string(name) + "." + format.extension);
      write_drawings(file, drawings, 1.0, {});
      std::ifstream stream(file, std::ios::binary);
      const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
      EXPECT_TRUE(bytes.starts_with(format.beginning)) << file;
      EXPECT_NE(bytes.find(format.content), std::string::npos) << file;
    }
  }
}

TEST(PathFigure, HasTheAxesOfItsMode) {
  const CircleRuns circles;
  FigureInput input = circles.both();
  const auto has = [&](const char* text) {
    return svg_text(figure(FigureKind::kPath, input, {})).find(std::string(">") + text + "</text>") !=
           std::string::npos;
  };
  EXPECT_TRUE(has("x [m]") && has("y [m]") && has("z [m]"));  // plan and side view
  input.path.mode = PlotMode::kZy;
  EXPECT_TRUE(!has("x [m]") && has("y [m]") && has("z [m]"));
  // The circle is 4 m in y (up) and 0.2 m in z.
  const std::vector<Polyline> truth =
      lines_of(figure(FigureKind::kPath, input, {}), theme::kBlack, theme::kTruthWidth);
  ASSERT_EQ(truth.size(), 1U);
  const auto [left, right] = std::ranges::minmax(truth[0].points, {}, &Point2::x);
  const auto [top, bottom] = std::ranges::minmax(truth[0].points, {}, &Point2::y);
  EXPECT_NEAR((bottom.y - top.y) / (right.x - left.x), 20.0, 1.0);
}

// A circle of radius 2 m in the plane z = 0: the view turns x to (0.866, -0.25) and y to (0.5, 0.433), so
// that its extent is 2 sqrt(0.75 + 0.25) to the right and 2 sqrt(0.0625 + 0.1875) upwards: half as high as
// wide.
TEST(PathFigure, ProjectsThreeDimensionsToScale) {
  CircleRuns circles;
  for (StampedPose& pose : circles.gt.poses) pose.T_w_f.p.z() = 0.0;
  FigureInput input = circles.both();
  input.path.mode = PlotMode::kXyz;
  const Drawing drawing = figure(FigureKind::kPath, input, {});
  const std::vector<Polyline> truth = lines_of(drawing, theme::kBlack, theme::kTruthWidth);
  ASSERT_EQ(truth.size(), 1U);
  const auto [left, right] = std::ranges::minmax(truth[0].points, {}, &Point2::x);
  const auto [top, bottom] = std::ranges::minmax(truth[0].points, {}, &Point2::y);
  EXPECT_NEAR((bottom.y - top.y) / (right.x - left.x), 0.5, 0.01);
  for (const char* title : {">x [m]<", ">y [m]<", ">z [m]<"})
    EXPECT_NE(svg_text(drawing).find(title), std::string::npos) << title;
}

TEST(PathFigure, HasALineOfEachColorForEachAxisOfAPose) {
  const CircleRuns circles;
  FigureInput input = circles.one();
  const auto count = [&](const Color& color) {
    const Drawing drawing = figure(FigureKind::kPath, input, {});
    return std::ranges::count_if(drawing.marks, [&](const Mark& mark) {
      const auto* const line = std::get_if<Polyline>(&mark);
      return line != nullptr && line->color.red == color.red && line->color.blue == color.blue;
    });
  };
  input.path.mode = PlotMode::kXy;
  for (const Color& color : theme::kPoseAxes) EXPECT_EQ(count(color), 0);
  input.path.pose_axes = true;
  // Every 10th of 201 poses (21), every 8th of 163 (21).
  for (const Color& color : theme::kPoseAxes) EXPECT_EQ(count(color), 42);
}

TEST(PathFigure, ConnectsPosesWithTheGroundTruth) {
  const CircleRuns circles;
  FigureInput input = circles.both();
  const auto lines = [&] {
    const Drawing drawing = figure(FigureKind::kPath, input, {});
    return std::ranges::count_if(drawing.marks, [](const Mark& mark) {
      const auto* const line = std::get_if<Polyline>(&mark);
      return line != nullptr && line->width == theme::kGridWidth && line->color.red == theme::kFrame.red;
    });
  };
  EXPECT_EQ(lines(), 0);
  input.path.correspondences = true;
  EXPECT_GT(lines(), 100);  // of two estimates in two views
}

TEST(PathFigure, HasTheLimitsOfItsColorBar) {
  const CircleRuns circles;
  FigureInput input = circles.one();
  input.path.least_error = 0.01;
  input.path.most_error = 0.03;
  EXPECT_NE(svg_text(figure(FigureKind::kPath, input, {})).find(">0.030</text>"), std::string::npos);
  input.path.most_error = 0.01;
  expect_input_error([&] { static_cast<void>(figure(FigureKind::kPath, input, {})); }, {"--colormap-min"});
}

// The error grows with time: it is 0.1 m times the fraction of the path, after alignment at most 0.1 m.
TEST(PathFigure, IsColoredByTheErrorThatIsAskedFor) {
  const CircleRuns circles;
  FigureInput input = circles.one();
  const auto has = [&](const std::string& text) {
    return svg_text(figure(FigureKind::kPath, input, {})).find(">" + text + "</text>") != std::string::npos;
  };
  EXPECT_TRUE(has("position error [m]") && has("RMSE [m]"));
  input.path.color = PathColor::kRotation;
  EXPECT_TRUE(has("rotation error [deg]") && has("RMSE [deg]"));
  input.path.color = PathColor::kRelative;
  EXPECT_TRUE(has("relative position error [m] over 1 s"));
  EXPECT_TRUE(has(short_number(statistics_of(relative_series(input, circles.runs[0]).position_m)->rmse)));
}

// One occupied cell of 0.1 m in a map that is turned by 90 deg: its columns go along y, its rows from below
// along -x.
TEST(PathFigure, HasAMapBelowThePaths) {
  const CircleRuns circles;
  datasets::OccupancyGrid grid{.columns = 40,
                               .rows = 40,
                               .resolution_m = 0.1,
                               .origin_x_m = 2.0,
                               .origin_y_m = -2.0,
                               .yaw_rad = 0.5 * std::numbers::pi,
                               .pixels = std::vector<std::uint8_t>(1600, 255)};
  // x = 2 - 0.1 (rows from below), y = -2 + 0.1 column.
  const std::size_t from_below = 20;
  const std::size_t column = 30;  // y in [1, 1.1), x in (-0.1, 0]
  grid.pixels[(39 - from_below) * 40 + column] = 0;
  FigureInput input = circles.both();
  datasets::MapWindow drawn;
  input.path.map = [&](const datasets::MapWindow& window) {
    drawn = window;
    return datasets::map_image(grid, window);
  };
  for (const PlotMode mode : {PlotMode::kXy, PlotMode::kYx}) {
    input.path.mode = mode;
    const Drawing drawing = figure(FigureKind::kPath, input, {});
    const auto mark =
        std::ranges::find_if(drawing.marks, [](const Mark& m) { return std::holds_alternative<Raster>(m); });
    ASSERT_NE(mark, drawing.marks.end());
    const auto& raster = std::get<Raster>(*mark);
    // 15 % of the 4 m of the path on each side.
    EXPECT_LT(std::max(drawn.x_low_m, drawn.y_low_m), -2.6);
    EXPECT_GT(std::min(drawn.x_high_m, drawn.y_high_m), 2.6);
    double x = 0.0;  // center of the dark pixels, as a fraction of the plot area
    double y = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < raster.rows() * raster.columns; ++i) {
      if (raster.pixels[3 * i] > 140) continue;
      x += (static_cast<double>(i % raster.columns) + 0.5) / static_cast<double>(raster.columns);
      y += (static_cast<double>(i / raster.columns) + 0.5) / static_cast<double>(raster.rows());
      ++count;
    }
    ASSERT_GT(count, 0.0);
    // Where the truth starts, (0, -2), and where it is at its highest, (0, 2), give the scale.
    const std::vector<Polyline> truth = lines_of(drawing, theme::kBlack, theme::kTruthWidth);
    ASSERT_EQ(truth.size(), 1U);
    const auto [left, right] = std::ranges::minmax(truth[0].points, {}, &Point2::x);
    const auto [top, bottom] = std::ranges::minmax(truth[0].points, {}, &Point2::y);
    const double at_x = raster.top_left.x + x / count * (raster.bottom_right.x - raster.top_left.x);
    const double at_y = raster.top_left.y + y / count * (raster.bottom_right.y - raster.top_left.y);
    const double to_right = -2.0 + 4.0 * (at_x - left.x) / (right.x - left.x);
    const double up = -2.0 + 4.0 * (bottom.y - at_y) / (bottom.y - top.y);
    EXPECT_NEAR(mode == PlotMode::kXy ? to_right : up, -0.05, 0.02);
    EXPECT_NEAR(mode == PlotMode::kXy ? up : to_right, 1.05, 0.02);
  }
  grid.origin_x_m = 100.0;
  expect_input_error([&] { static_cast<void>(figure(FigureKind::kPath, input, {})); },
                     {"--occupancy-grid", "ground truth"});
}

TEST(ErrorFigure, IsOverTheAxisThatIsAskedFor) {
  const CircleRuns circles;
  FigureInput input = circles.both();
  const auto has = [&](FigureKind kind, const char* text) {
    return svg_text(figure(kind, input, {})).find(std::string(">") + text + "</text>") != std::string::npos;
  };
  input.error_axis = ErrorAxis::kIndex;
  EXPECT_TRUE(has(FigureKind::kError, "index of the pose") && !has(FigureKind::kError, "time [s]"));
  // The poses from 8 to 12 s are missing: over the index, both parts of the line meet.
  const std::vector<Polyline> lines =
      lines_of(figure(FigureKind::kError, input, {}), theme::kEstimates[0].color, theme::kEstimateWidth);
  ASSERT_GE(lines.size(), 2U);
  const double width = lines[1].points.back().x - lines[0].points.front().x;
  EXPECT_NEAR(lines[1].points.front().x - lines[0].points.back().x, width / 161.0, 1.0);  // one pose
  EXPECT_TRUE(has(FigureKind::kRelative, "distance error [m]"));
  input.error_axis = ErrorAxis::kDistance;
  EXPECT_TRUE(has(FigureKind::kTransform, "distance traveled [m]"));
}

// The estimate moves by 0.1 / 200 m too far along x in each pose, 0.005 m in 1 s, after an alignment that
// turns it little: the relative error is 0.005 m where nothing is missing.
TEST(RelativeFigure, HasTheErrorsOfPosesAnIntervalApart) {
  const CircleRuns circles;
  const FigureInput input = circles.one();
  const RelativeSeries series = relative_series(input, circles.runs[0]);
  ASSERT_FALSE(series.position_m.empty());
  EXPECT_EQ(series.position_m.size(), series.distance_m.size());
  EXPECT_NEAR(series.position_m.front().t_s, 1.0, 1e-9);  // the time of the later pose
  for (std::size_t i = 0; i < series.position_m.size(); ++i) {
    const double t_s = series.position_m[i].t_s;
    EXPECT_FALSE(t_s > 8.05 && t_s < 12.95) << t_s;  // one of both poses is missing
    EXPECT_NEAR(series.position_m[i].at.y, 0.005, 1e-6);
    EXPECT_LE(series.distance_m[i].at.y, series.position_m[i].at.y + 1e-9);
    EXPECT_NEAR(
        series.transform[i].at.y,
        std::hypot(series.position_m[i].at.y,
                   std::sqrt(8.0) * std::sin(0.5 * series.rotation_deg[i].at.y * std::numbers::pi / 180.0)),
        1e-12);
  }
  FigureInput long_interval = input;
  long_interval.rpe_delta = 100.0;
  expect_input_error([&] { static_cast<void>(figure(FigureKind::kRelative, long_interval, {})); },
                     {"--figure relative", "100 s apart", "--rpe-delta"});
}

TEST(ErrorFigure, HasLinesOfMeanAndMedianForASingleEstimate) {
  const CircleRuns circles;
  const std::string one = svg_text(figure(FigureKind::kError, circles.one(), {}));
  EXPECT_NE(one.find(">median</text>"), std::string::npos);
  EXPECT_NE(one.find(">mean ± std"), std::string::npos);
  EXPECT_EQ(svg_text(figure(FigureKind::kError, circles.both(), {})).find(">mean ±"), std::string::npos);
}

// Errors of 0.06 m (one pose) and 0.55 m (three): bins of 0.05 m, of which at most 25 are in [0, 0.55].
TEST(HistogramFigure, CountsPosesInBins) {
  CircleRuns circles;
  circles.near_errors.per_pose.resize(4);
  for (eval::PoseError& pose : circles.near_errors.per_pose) pose.translation_m = 0.55;
  circles.near_errors.per_pose.front().translation_m = 0.06;
  const Drawing drawing = figure(FigureKind::kHistogram, circles.one(), {});
  const std::vector<Polyline> outlines = lines_of(drawing, theme::kEstimates[0].color, theme::kEstimateWidth);
  ASSERT_FALSE(outlines.empty());
  double floor = 0.0;
  double highest = 1e9;
  double one = 1e9;  // in the left half
  const double middle = 0.5 * (outlines[0].points.front().x + outlines[0].points.back().x);
  for (const Point2& p : outlines[0].points) {
    floor = std::max(floor, p.y);
    highest = std::min(highest, p.y);
    if (p.x < middle) one = std::min(one, p.y);
  }
  EXPECT_NEAR((floor - highest) / (floor - one), 3.0, 0.01);
}

TEST(BarsFigure, HasABarOfEachStatisticAndEstimate) {
  const CircleRuns circles;
  const Drawing drawing = figure(FigureKind::kBars, circles.both(), {});
  const auto bars = std::ranges::count_if(drawing.marks, [](const Mark& mark) {
    const auto* const polygon = std::get_if<Polygon>(&mark);
    return polygon != nullptr && polygon->color.red == theme::kEstimates[1].color.red;
  });
  EXPECT_EQ(bars, 13);  // six of positions, six of rotations, the sample of the legend
}

// Dashes of line styles mean nothing beside bars and boxes.
TEST(Figures, HaveAreasInTheLegendWhereNoLinesAreDrawn) {
  const CircleRuns circles;
  for (const FigureKind kind : {FigureKind::kBars, FigureKind::kBox, FigureKind::kRpe}) {
    const Drawing drawing = figure(kind, circles.both(), {});
    EXPECT_TRUE(std::ranges::none_of(drawing.marks, [](const Mark& mark) {
      const auto* const line = std::get_if<Polyline>(&mark);
      return line != nullptr && !line->dashes.empty();
    }));
  }
}

TEST(Figures, HaveThreeTicksOrMoreOnAnAxis) {
  CircleRuns circles;
  // Rotations of up to 3.5 deg: steps of 2 deg, which column width has room for, give 0 and 2 only.
  for (Trajectory* path : {&circles.gt, &circles.near}) {
    for (std::size_t i = 0; i < path->poses.size(); ++i) {
      const double deg = -0.8 + 4.2 * static_cast<double>(i % 2);
      path->poses[i].T_w_f.q = Eigen::AngleAxisd(deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitX());
    }
  }
  circles.near_errors = eval::evaluate("strict:se3", {circles.gt, circles.near, circles.options});
  const std::string svg = svg_text(figure(FigureKind::kRotation, circles.one(), {}));
  EXPECT_NE(svg.find(">1</text>"), std::string::npos);
  EXPECT_NE(svg.find(">3</text>"), std::string::npos);
}

TEST(Figures, ExplainTheirBoxesInWholeLines) {
  const CircleRuns circles;
  const std::string svg = svg_text(figure(FigureKind::kBox, circles.both(), {}));
  EXPECT_NE(svg.find("Violins: density"), std::string::npos);
  EXPECT_NE(svg.find("RMSE.</text>"), std::string::npos);  // the last word is there
  EXPECT_EQ(svg.find("\u2026"), std::string::npos);
}

TEST(Figures, HaveTheWidthAndTheFontThatAreAskedFor) {
  const CircleRuns circles;
  for (const auto& [kind, name] : enum_names(FigureKind{})) {
    const Drawing drawing = figure(kind, circles.both(), {.width_mm = 85.0, .font_size_pt = 7.0});
    EXPECT_NEAR(drawing.width, 240.94, 0.01) << name;  // 85 mm in points
    EXPECT_NE(svg_text(drawing).find("font-size=\"7.00\""), std::string::npos) << name;
    EXPECT_NE(svg_text(drawing).find("width=\"240.94pt\""), std::string::npos) << name;
  }
}

TEST(Figures, StayWithinTheirBorders) {
  const CircleRuns circles;
  for (const auto& [kind, name] : enum_names(FigureKind{})) {
    const Drawing drawing = figure(kind, circles.both(), {});
    for (const Mark& mark : drawing.marks) {
      const auto* const line = std::get_if<Polyline>(&mark);
      if (line == nullptr) continue;
      for (const Point2& p : line->points) {
        EXPECT_TRUE(p.x >= 0.0 && p.x <= drawing.width && p.y >= 0.0 && p.y <= drawing.height) << name;
      }
    }
    for (const Mark& mark : drawing.marks) {
      const auto* const label = std::get_if<Label>(&mark);
      if (label == nullptr || label->upwards) continue;
      const double width = text_width(label->text, label->size);
      const double left = label->at.x - (label->anchor == Anchor::kLeft     ? 0.0
                                         : label->anchor == Anchor::kMiddle ? 0.5 * width
                                                                            : width);
      EXPECT_GE(left, -0.5) << name << ": " << label->text;
      EXPECT_LE(left + width, drawing.width + 0.5) << name << ": " << label->text;
    }
  }
}

TEST(Figures, ShowEstimatesThatAreLongerThanTheTruth) {
  CircleRuns circles;
  circles.gt.poses.erase(circles.gt.poses.begin(), circles.gt.poses.begin() + 50);
  circles.gt.poses.resize(circles.gt.poses.size() - 50);
  for (const FigureKind kind : {FigureKind::kAxes, FigureKind::kRotation, FigureKind::kSpeed}) {
    const Drawing drawing = figure(kind, circles.both(), {});
    for (const Mark& mark : drawing.marks) {
      const auto* const line = std::get_if<Polyline>(&mark);
      if (line == nullptr) continue;
      for (const Point2& p : line->points) EXPECT_TRUE(p.x >= 0.0 && p.x <= drawing.width);
    }
  }
}

TEST(Figures, HaveNumbersInTheLegend) {
  const CircleRuns circles;
  const std::string svg = svg_text(figure(FigureKind::kError, circles.both(), {}));
  EXPECT_NE(svg.find(">RMSE [m]</text>"), std::string::npos);
  EXPECT_NE(svg.find(">" + short_number(circles.far_errors.ate_m->rmse) + "</text>"), std::string::npos);
  EXPECT_NE(svg.find(">" + std::to_string(circles.far_errors.pairs) + "</text>"), std::string::npos);
  EXPECT_EQ(svg.find("ground truth"), std::string::npos);  // it has no error
}

TEST(Figures, NameTheirAxes) {
  const CircleRuns circles;
  const auto has = [&](FigureKind kind, const char* text) {
    return svg_text(figure(kind, circles.both(), {})).find(std::string(">") + text + "</text>") !=
           std::string::npos;
  };
  EXPECT_TRUE(has(FigureKind::kAxes, "z [m]"));
  EXPECT_TRUE(has(FigureKind::kRotation, "yaw [deg]"));
  EXPECT_TRUE(has(FigureKind::kError, "distance traveled [m]"));
  EXPECT_TRUE(has(FigureKind::kRpe, "length of the segments [m]"));
  EXPECT_TRUE(has(FigureKind::kBox, "position error [m]"));
  EXPECT_TRUE(has(FigureKind::kCdf, "fraction of poses"));
  EXPECT_TRUE(has(FigureKind::kSpeed, "rotation rate [deg/s]"));
}

TEST(RotationFigure, HasTheOrientationsOfTheErrorsOnAStraightPath) {
  Trajectory gt;
  Trajectory est;
  const Eigen::Quaterniond R(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()));
  for (int i = 0; i <= 100; ++i) {
    const Eigen::Quaterniond q(Eigen::AngleAxisd(0.3 * std::sin(0.1 * i), Eigen::Vector3d::UnitY()));
    const Eigen::Vector3d p(0.02 * i, 0.0, 0.0);
    gt.poses.emplace_back(from_seconds(0.1 * i), Pose{q, p});
    est.poses.emplace_back(from_seconds(0.1 * i), Pose{R * q, p});
  }
  const eval::Evaluation errors = eval::evaluate("strict:se3", {gt, est, {}});
  ASSERT_LT(errors.ate_deg.value().max, 1e-3);
  const std::vector<PlottedRun> runs{{"est", &est, &errors}};
  const Drawing drawing = figure(FigureKind::kRotation, {.gt = gt, .runs = runs}, {});
  const auto truth = lines_of(drawing, theme::kBlack, theme::kTruthWidth);
  const auto estimate = lines_of(drawing, theme::kEstimates.front().color, theme::kEstimateWidth);
  ASSERT_EQ(truth.size(), 3U);  // roll, pitch, yaw
  ASSERT_EQ(estimate.size(), 3U);
  for (std::size_t angle = 0; angle < truth.size(); ++angle)
    EXPECT_NEAR(estimate[angle].points[20].y, truth[angle].points[20].y, 0.1) << angle;
}

TEST(BoxFigure, HasTheDensityOfTheErrorsBehindTheBoxes) {
  CircleRuns circles;
  for (std::size_t i = 0; i < circles.near_errors.per_pose.size(); ++i)
    circles.near_errors.per_pose[i].translation_m = (i % 2 == 0 ? 0.1 : 0.3) + 1e-4 * static_cast<double>(i);
  const Drawing drawing = figure(FigureKind::kBox, circles.one(), {});
  std::vector<double> widths;
  for (const Mark& mark : drawing.marks) {
    const auto* const polygon = std::get_if<Polygon>(&mark);
    if (polygon == nullptr || polygon->points.size() < 20) continue;
    const std::vector<Point2>& outline = polygon->points;
    for (std::size_t k = 0; k < outline.size() / 2; ++k)
      widths.push_back(std::abs(outline[k].y - outline[outline.size() - 1 - k].y));
    break;  // of positions
  }
  ASSERT_GT(widths.size(), 20U);
  const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
  const double largest = std::ranges::max(widths);
  EXPECT_LT(*middle, 0.5 * largest);  // two modes
  EXPECT_GT(*std::max_element(widths.begin(), middle), 0.9 * largest);
  EXPECT_GT(*std::max_element(middle, widths.end()), 0.9 * largest);
}

TEST(Figures, RefuseRotationsThatCannotBeCompared) {
  CircleRuns circles;
  for (StampedPose& pose : circles.near.poses) pose.T_w_f.q.setIdentity();
  circles.near_errors = eval::evaluate("strict:se3", {circles.gt, circles.near, circles.options});
  expect_input_error([&] { static_cast<void>(figure(FigureKind::kRotation, circles.one(), {})); },
                     {"--figure rotation"});
  EXPECT_EQ(svg_text(figure(FigureKind::kError, circles.one(), {})).find("rotation error"),
            std::string::npos);
}

TEST(PlanMap, PointsToTheNorthOfAReceiver) {
  CircleRuns circles;
  EXPECT_EQ(svg_text(plan_map(circles.both(), {})).find(">N<"), std::string::npos);
  circles.gt.frame = eval::kGnssFrame;
  const std::string svg = svg_text(plan_map(circles.both(), {}));
  EXPECT_NE(svg.find(">N<"), std::string::npos);
  EXPECT_NE(svg.find(">north [m]<"), std::string::npos);
  EXPECT_NE(svg.find(">1 m<"), std::string::npos);  // the scale bar of a circle of 4 m
}

}  // namespace
}  // namespace stillpoint::report
