// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/calibration_figure.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "reports/drawing/theme.h"

namespace stillpoint::bench {
namespace {

namespace theme = report::theme;
using report::Point2;

constexpr int kColumns = 16;
constexpr int kLeastCount = 5;  // residuals in a cell whose mean is drawn
constexpr double kPanelWidth = 240.0, kMargin = 10.0, kHeading = 34.0;

struct Cell {
  Eigen::Vector2d sum_px = Eigen::Vector2d::Zero();
  int count = 0;

  [[nodiscard]] bool is_drawn() const { return count >= kLeastCount; }
  [[nodiscard]] Eigen::Vector2d mean_px() const { return sum_px / count; }
};

/// Means over a grid of square cells, row by row.
struct Field {
  std::vector<Cell> cells;
  int rows = 1;

  Field(std::span<const ImageResidual> residuals, const Camera& camera) {
    const double side_px = static_cast<double>(camera.width) / kColumns;
    rows = std::max(1, static_cast<int>(std::ceil(camera.height / side_px)));
    cells.resize(static_cast<std::size_t>(rows * kColumns));
    for (const ImageResidual& residual : residuals) {
      const int column = std::clamp(static_cast<int>(residual.pixel.x() / side_px), 0, kColumns - 1);
      const int row = std::clamp(static_cast<int>(residual.pixel.y() / side_px), 0, rows - 1);
      Cell& cell = cells[static_cast<std::size_t>(row * kColumns + column)];
      cell.sum_px += residual.error_px;
      ++cell.count;
    }
  }

  [[nodiscard]] double largest_px() const {
    double largest = 0.0;
    for (const Cell& cell : cells)
      if (cell.is_drawn()) largest = std::max(largest, cell.mean_px().norm());
    return largest;
  }

  [[nodiscard]] double rms_px() const {
    double sum = 0.0;
    int count = 0;
    for (const Cell& cell : cells) {
      if (!cell.is_drawn()) continue;
      sum += cell.mean_px().squaredNorm();
      ++count;
    }
    return count == 0 ? 0.0 : std::sqrt(sum / count);
  }
};

void add_line(report::Drawing& drawing, std::vector<Point2> points, const report::Color& color,
              double width) {
  drawing.marks.emplace_back(report::Polyline{.points = std::move(points), .color = color, .width = width});
}

/// A line from the tail with a disc at the tail: the other end is where the prediction is.
void add_arrow(report::Drawing& drawing, const Point2& tail, const Eigen::Vector2d& along) {
  const report::Color& color = theme::kEstimates.front().color;
  drawing.marks.emplace_back(report::Disc{.center = tail, .radius = 0.9, .color = color});
  add_line(drawing, {tail, {tail.x + along.x(), tail.y + along.y()}}, color, theme::kEstimateWidth);
}

/// @param scale units of the drawing per pixel of the residuals
void add_panel(report::Drawing& drawing, const Field& field, double left, double scale) {
  const double side = kPanelWidth / kColumns, bottom = kHeading + field.rows * side;
  add_line(drawing,
           {{left, kHeading},
            {left + kPanelWidth, kHeading},
            {left + kPanelWidth, bottom},
            {left, bottom},
            {left, kHeading}},
           theme::kFrame, theme::kFrameWidth);
  for (int row = 0; row < field.rows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Cell& cell = field.cells[static_cast<std::size_t>(row * kColumns + column)];
      if (!cell.is_drawn()) continue;
      add_arrow(drawing, {left + (column + 0.5) * side, kHeading + (row + 0.5) * side},
                scale * cell.mean_px());
    }
  }
}

void add_text(report::Drawing& drawing, const Point2& at, const std::string& text) {
  drawing.marks.emplace_back(
      report::Label{.at = at, .text = text, .size = theme::kFontSizePt, .color = theme::kBlack});
}

}  // namespace

report::Drawing residual_figure(const HeldOutResiduals& residuals, const Camera& camera) {
  const Field before(residuals.before, camera), after(residuals.after, camera);
  const double side = kPanelWidth / kColumns;
  const double largest_px = std::max({before.largest_px(), after.largest_px(), 1e-6});
  const double cell_px = 2.0 * largest_px;  // the longest line ends at the border of its cell
  report::Drawing drawing{.width = 2.0 * kPanelWidth + 3.0 * kMargin,
                          .height = kHeading + before.rows * side + 20.0,
                          .title = "Residual fields",
                          .unit_is_a_point = true};
  const double left[] = {kMargin, 2.0 * kMargin + kPanelWidth};
  add_text(drawing, {left[0], 12.0}, "stated calibration");
  add_text(drawing, {left[1], 12.0}, "found calibration, that of the first half");
  const auto summary = [](double rms_px, const Field& field) {
    return fmt::format("residuals {:.3f} px, means of cells {:.3f} px", rms_px, field.rms_px());
  };
  add_text(drawing, {left[0], 26.0}, summary(residuals.pixel_before_px, before));
  add_text(drawing, {left[1], 26.0}, summary(residuals.pixel_after_px, after));
  add_panel(drawing, before, left[0], side / cell_px);
  add_panel(drawing, after, left[1], side / cell_px);
  add_text(drawing, {left[0], drawing.height - 6.0},
           fmt::format(
               "mean reprojection error of a cell of {:.0f} px, second half of the keyframes; a line as long "
               "as a cell: {:.3f} px",
               static_cast<double>(camera.width) / kColumns, cell_px));
  return drawing;
}

}  // namespace stillpoint::bench
