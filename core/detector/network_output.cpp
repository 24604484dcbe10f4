// SPDX-License-Identifier: BSD-3-Clause
#include "core/detector/network_output.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/error.h"
#include "core/types/box_geometry.h"

namespace stillpoint {
namespace {

constexpr int kBoxValues = 4;
constexpr std::array<int, 3> kYoloxStrides = {8, 16, 32};

bool has_objectness(NetworkLayout layout) { return layout != NetworkLayout::kYolov8; }

std::string shape_text(const cv::Mat& output) {
  std::string text;
  for (int i = 0; i < output.dims; ++i) text += (i > 0 ? " x " : "") + std::to_string(output.size[i]);
  return text;
}

/// Total number of cells of the three grids of YOLOX.
int yolox_cells(int input_px) {
  int cells = 0;
  for (const int stride : kYoloxStrides) cells += (input_px / stride) * (input_px / stride);
  return cells;
}

/// Output with one row per box, without leading dimensions of size 1; nullopt if the shape does not match.
std::optional<cv::Mat> as_rows(const DecodeOptions& options, const cv::Mat& output) {
  const int columns =
      kBoxValues + (has_objectness(options.layout) ? 1 : 0) + static_cast<int>(options.names.size());
  if (output.dims < 2 || output.type() != CV_32F || !output.isContinuous()) return std::nullopt;
  const int last = output.size[output.dims - 1];
  const int before = output.size[output.dims - 2];
  if (output.total() != static_cast<std::size_t>(last) * static_cast<std::size_t>(before))
    return std::nullopt;
  const cv::Mat flat(before, last, CV_32F, output.data);
  if (options.layout == NetworkLayout::kYolov8) {
    return before == columns ? std::optional<cv::Mat>(flat.t()) : std::nullopt;
  }
  if (options.layout == NetworkLayout::kYolox && before != yolox_cells(options.input_px)) return std::nullopt;
  return last == columns ? std::optional(flat.clone()) : std::nullopt;
}

/// YOLOX boxes in px of the input instead of grid units.
cv::Mat decode_yolox_grids(cv::Mat rows, int input_px) {
  int row = 0;
  for (const int stride : kYoloxStrides) {
    const int side = input_px / stride;
    for (int cell = 0; cell < side * side; ++cell, ++row) {
      float* const values = rows.ptr<float>(row);
      values[0] = (values[0] + static_cast<float>(cell % side)) * static_cast<float>(stride);
      values[1] = (values[1] + static_cast<float>(cell / side)) * static_cast<float>(stride);
      values[2] = std::exp(values[2]) * static_cast<float>(stride);
      values[3] = std::exp(values[3]) * static_cast<float>(stride);
    }
  }
  return rows;
}

/// Box of one row; nullopt if its best score is below the threshold.
std::optional<Detection> decode_row(const DecodeOptions& options, const float* values) {
  const float* const scores = values + kBoxValues + (has_objectness(options.layout) ? 1 : 0);
  const float* const best = std::max_element(scores, scores + options.names.size());
  const bool scores_are_conditional =
      options.layout == NetworkLayout::kYolov5 || options.layout == NetworkLayout::kYolox;
  const double score = scores_are_conditional ? double(*best) * double(values[kBoxValues]) : double(*best);
  if (!(score >= options.score_threshold)) return std::nullopt;
  const double scale = options.layout == NetworkLayout::kDarknet ? options.input_px : 1.0;
  const double x = scale * double(values[0]), y = scale * double(values[1]);
  const double half_width = 0.5 * scale * double(values[2]), half_height = 0.5 * scale * double(values[3]);
  return Detection{.class_name = options.names[static_cast<std::size_t>(best - scores)],
                   .score = std::min(score, 1.0),
                   .box = {.x_min = x - half_width,
                           .y_min = y - half_height,
                           .x_max = x + half_width,
                           .y_max = y + half_height}};
}

}  // namespace

std::vector<Detection> decode_outputs(const DecodeOptions& options, const std::vector<cv::Mat>& outputs,
                                      const std::string& source) {
  std::vector<Detection> detections;
  for (const cv::Mat& output : outputs) {
    std::optional<cv::Mat> rows = as_rows(options, output);
    if (!rows) {
      throw InputError(source, "has an output of shape " + shape_text(output) +
                                   ", which does not match the layout with " +
                                   std::to_string(options.names.size()) +
                                   " classes; check detector.layout, detector.names and detector.input_px");
    }
    if (options.layout == NetworkLayout::kYolox) rows = decode_yolox_grids(*rows, options.input_px);
    for (int row = 0; row < rows->rows; ++row) {
      std::optional<Detection> detection = decode_row(options, rows->ptr<float>(row));
      if (detection) detections.push_back(std::move(*detection));
    }
  }
  return detections;
}

std::vector<Detection> non_maximum_suppression(std::vector<Detection> detections, double max_iou) {
  std::stable_sort(detections.begin(), detections.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  std::vector<Detection> remaining;
  for (Detection& candidate : detections) {
    const bool duplicate = std::any_of(remaining.begin(), remaining.end(), [&](const Detection& better) {
      return better.class_name == candidate.class_name &&
             intersection_over_union(better.box, candidate.box) > max_iou;
    });
    if (!duplicate) remaining.push_back(std::move(candidate));
  }
  return remaining;
}

}  // namespace stillpoint
