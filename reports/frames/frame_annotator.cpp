// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/frame_annotator.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace stillpoint::report {
namespace {

// R, G, B
const cv::Scalar kStable(60, 220, 60);
const cv::Scalar kObject(255, 50, 40);
const cv::Scalar kMotion(255, 60, 255);
const cv::Scalar kUnlabeled(255, 255, 255);
const cv::Scalar kStableCircle(255, 165, 0);
const cv::Scalar kUnstableCircle(150, 70, 220);
const cv::Scalar kDetected(255, 230, 0);
const cv::Scalar kCompensated(60, 140, 255);
const cv::Scalar kText(255, 255, 255);
const cv::Scalar kShadow(0, 0, 0);

constexpr int kTextFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.5;
constexpr int kCorrectionFrames = 30;
constexpr int kFractionBits = 4;  // OpenCV takes coordinates in 1/16 px

cv::Point fixed(const cv::Point2d& pixel) {
  return {cvRound(pixel.x * (1 << kFractionBits)), cvRound(pixel.y * (1 << kFractionBits))};
}

cv::Mat canvas_of(const Frame& frame) {
  const cv::Mat color = color_image(frame);
  if (!color.empty()) return color.clone();
  cv::Mat canvas;
  cv::cvtColor(frame.gray, canvas, cv::COLOR_GRAY2RGB);
  return canvas;
}

/// Tints pixels that Eq. (1) assigns to a dynamic object.
void draw_mask(const Frame& frame, const SemanticMask& mask, cv::Mat& canvas) {
  if (mask.boxes().empty() || frame.depth.size() != canvas.size()) return;
  for (int row = 0; row < canvas.rows; ++row) {
    for (int column = 0; column < canvas.cols; ++column) {
      const double depth = frame.depth.at<std::uint16_t>(row, column) / frame.depth_units_per_m;
      if (depth <= 0.0 || depth >= mask.threshold_at({column, row})) continue;
      cv::Vec3b& pixel = canvas.at<cv::Vec3b>(row, column);
      pixel[0] = static_cast<std::uint8_t>((pixel[0] + 255) / 2);
      pixel[1] = static_cast<std::uint8_t>(pixel[1] / 2);
      pixel[2] = static_cast<std::uint8_t>(pixel[2] / 2);
    }
  }
}

void write_line(const std::string& text, const cv::Point& at, cv::Mat& canvas) {
  cv::putText(canvas, text, at + cv::Point(1, 1), kTextFont, kFontScale, kShadow, 2, cv::LINE_AA);
  cv::putText(canvas, text, at, kTextFont, kFontScale, kText, 1, cv::LINE_AA);
}

void draw_boxes(const std::vector<TrackedBox>& boxes, cv::Mat& canvas) {
  for (const TrackedBox& tracked : boxes) {
    const cv::Point2d low(tracked.box.x_min, tracked.box.y_min);
    const cv::Point2d high(tracked.box.x_max, tracked.box.y_max);
    const cv::Scalar& color = tracked.compensated ? kCompensated : kDetected;
    cv::rectangle(canvas, fixed(low), fixed(high), color, 2, cv::LINE_AA, kFractionBits);
    const std::string label = tracked.class_name + (tracked.compensated ? " (compensated)" : "");
    write_line(label, cv::Point(std::max(cvRound(low.x), 0) + 4, std::max(cvRound(low.y), 0) + 16), canvas);
  }
}

void write_status(const OdometryUpdate& update, cv::Mat& canvas) {
  const std::string text = std::to_string(update.frame_id) + "  " + std::string(status_name(update.status)) +
                           "  " + std::to_string(update.counters.tracked_features) + " features, " +
                           std::to_string(update.counters.dynamic_features) + " dynamic";
  write_line(text, cv::Point(6, canvas.rows - 8), canvas);
}

/// Change of the correction by loop closure, at the position of the camera.
std::string correction_text(const Pose& before, const OdometryUpdate& update) {
  const Eigen::Vector3d moved = update.T_m_w * update.T_w_c.p - before * update.T_w_c.p;
  const double angle_rad = before.q.angularDistance(update.T_m_w.q);
  return fmt::format("loop closure: corrected by {:.1f} cm, {:.2f} deg", 100.0 * moved.norm(),
                     angle_rad * 180.0 / std::numbers::pi);
}

bool is_same(const Pose& a, const Pose& b) { return a.p == b.p && a.q.coeffs() == b.q.coeffs(); }

}  // namespace

FrameAnnotator::Tracks FrameAnnotator::extended_tracks(const FrameReport& report) const {
  Tracks now;
  for (const TrackedFeature& feature : report.tracked.features) {
    const auto before = tracks_.find(feature.id);
    Track track = before == tracks_.end() ? Track{} : before->second;
    track.pixels.emplace_back(feature.pixel.x(), feature.pixel.y());
    if (track.pixels.size() > style_.track_length) track.pixels.erase(track.pixels.begin());
    now.emplace(feature.id, std::move(track));
  }
  for (const DynamicLabel& label : report.dynamic.labels) {
    const auto track = now.find(label.id);
    if (track == now.end()) continue;
    track->second.has_label = true;
    track->second.label = label.label;
  }
  return now;
}

void FrameAnnotator::draw_circles(const Tracks& now, cv::Mat& canvas) const {
  const auto draw = [&canvas](const cv::Point2d& at, int radius_px, const cv::Scalar& color) {
    if (radius_px > 0)
      cv::circle(canvas, fixed(at), radius_px << kFractionBits, color, 1, cv::LINE_AA, kFractionBits);
  };
  for (const auto& [id, track] : now) draw(track.pixels.back(), style_.stable_radius_px, kStableCircle);
  for (const auto& [id, track] : tracks_) {
    if (!now.contains(id)) draw(track.pixels.back(), style_.unstable_radius_px, kUnstableCircle);
  }
}

/// A world that is located in the map, or a new world, is not a correction.
void FrameAnnotator::note_correction(const OdometryUpdate& update) {
  if (in_map_ && update.in_map && !is_same(update.T_m_w, T_m_w_)) {
    correction_ = correction_text(T_m_w_, update);
    correction_frames_ = kCorrectionFrames;
  }
  T_m_w_ = update.T_m_w;
  in_map_ = update.in_map;
}

cv::Mat FrameAnnotator::annotate(const FrameReport& report) {
  cv::Mat canvas = canvas_of(report.frame);
  Tracks now = extended_tracks(report);
  draw_mask(report.frame, report.dynamic.mask, canvas);
  draw_circles(now, canvas);
  draw_boxes(report.dynamic.boxes, canvas);
  for (const auto& [id, track] : now) {
    const cv::Scalar& color = !track.has_label                            ? kUnlabeled
                              : track.label == LabelClass::kDynamicObject ? kObject
                              : track.label == LabelClass::kDynamicMotion ? kMotion
                                                                          : kStable;
    std::vector<cv::Point> points;
    for (const cv::Point2d& pixel : track.pixels) points.push_back(fixed(pixel));
    cv::polylines(canvas, points, false, color, 1, cv::LINE_AA, kFractionBits);
    cv::circle(canvas, points.back(), 3 << kFractionBits, color, cv::FILLED, cv::LINE_AA, kFractionBits);
  }
  write_status(report.update, canvas);
  note_correction(report.update);
  if (correction_frames_-- > 0) write_line(correction_, cv::Point(6, canvas.rows - 26), canvas);
  tracks_ = std::move(now);
  return canvas;
}

}  // namespace stillpoint::report
