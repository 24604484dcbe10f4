// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/drawing.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "datasets/io/image_io.h"

namespace stillpoint::report {
namespace {

constexpr int kShift = 4;  // OpenCV takes coordinates in 1/16 px
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontHeightPx = 30.0;  // line height of kFont at scale 1
constexpr double kStrokeRatio = 0.065;  // stroke width / font height

class Raster {
 public:
  Raster(const Drawing& drawing, double scale)
      : scale_(scale),
        image_(static_cast<int>(std::ceil(drawing.height * scale)),
               static_cast<int>(std::ceil(drawing.width * scale)), CV_8UC3, cv::Scalar(255, 255, 255)) {}

  void operator()(const Polyline& line) {
    std::vector<cv::Point> points;
    for (const Point2& point : line.points) points.push_back(fixed(point));
    cv::polylines(image_, points, false, scalar(line.color), px(line.width), cv::LINE_AA, kShift);
  }
  void operator()(const Disc& disc) {
    cv::circle(image_, fixed(disc.center),
               static_cast<int>(std::lround(disc.radius * scale_ * (1 << kShift))), scalar(disc.color),
               cv::FILLED, cv::LINE_AA, kShift);
  }
  void operator()(const Label& label) {
    const double font_scale = label.size * scale_ / kFontHeightPx;
    const int stroke = px(label.size * kStrokeRatio);
    int base_line = 0;
    const cv::Size size = cv::getTextSize(label.text, kFont, font_scale, stroke, &base_line);
    const int shift = label.anchor == Anchor::kLeft     ? 0
                      : label.anchor == Anchor::kMiddle ? size.width / 2
                                                        : size.width;
    const cv::Point at(static_cast<int>(std::lround(label.at.x * scale_)) - shift,
                       static_cast<int>(std::lround(label.at.y * scale_)));
    cv::putText(image_, label.text, at, kFont, font_scale, scalar(label.color), stroke, cv::LINE_AA);
  }

  [[nodiscard]] const cv::Mat& image() const { return image_; }

 private:
  [[nodiscard]] static cv::Scalar scalar(const Color& color) {
    return {double(color.red), double(color.green), double(color.blue)};
  }
  [[nodiscard]] int px(double units) const {
    return std::max(1, static_cast<int>(std::lround(units * scale_)));
  }
  [[nodiscard]] cv::Point fixed(const Point2& point) const {
    const auto coordinate = [this](double units) {
      return static_cast<int>(std::lround(units * scale_ * (1 << kShift)));
    };
    return {coordinate(point.x), coordinate(point.y)};
  }

  double scale_;
  cv::Mat image_;
};

}  // namespace

void write_drawing_png(const std::filesystem::path& file, const Drawing& drawing, double scale) {
  Raster raster(drawing, scale);
  for (const Mark& mark : drawing.marks) std::visit(raster, mark);
  datasets::write_png(file, raster.image());
}

}  // namespace stillpoint::report
