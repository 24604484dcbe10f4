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

constexpr int kBoxNumbers = 4;
constexpr std::array<int, 3> kYoloxStrides = {8, 16, 32};

bool has_objectness(NetworkLayout layout) { return layout != NetworkLayout::kYolov8; }

std::string shape_text(const cv::Mat& output) {
  std::string text;
  for (int i = 0; i < output.dims; ++i) text += (i > 0 ? " x " : "") + std::to_string(output.size[i]);
  return text;
}

/// Cells of the three grids of YOLOX.
int yolox_cells(int input_px) {
  int cells = 0;
  for (const int stride : kYoloxStrides) cells += (input_px / stride) * (input_px / stride);
  return cells;
}

/// The output as one row per box, whatever the number of leading dimensions; nothing if it does not fit.
std::optional<cv::Mat> as_rows(const OutputReader& reader, const cv::Mat& output) {
  const int columns =
      kBoxNumbers + (has_objectness(reader.layout) ? 1 : 0) + static_cast<int>(reader.names.size());
  if (output.dims < 2 || output.type() != CV_32F || !output.isContinuous()) return std::nullopt;
  const int last = output.size[output.dims - 1];
  const int before = output.size[output.dims - 2];
  if (output.total() != static_cast<std::size_t>(last) * static_cast<std::size_t>(before))
    return std::nullopt;
  const cv::Mat flat(before, last, CV_32F, output.data);
  if (reader.layout == NetworkLayout::kYolov8) {
    return before == columns ? std::optional<cv::Mat>(flat.t()) : std::nullopt;
  }
  if (reader.layout == NetworkLayout::kYolox && before != yolox_cells(reader.input_px)) return std::nullopt;
  return last == columns ? std::optional(flat.clone()) : std::nullopt;
}

/// Boxes of YOLOX from the grid to px of the input, in place.
void unfold_grids(cv::Mat& rows, int input_px) {
  int row = 0;
  for (const int stride : kYoloxStrides) {
    const int side = input_px / stride;
    for (int cell = 0; cell < side * side; ++cell, ++row) {
      float* const numbers = rows.ptr<float>(row);
      numbers[0] = (numbers[0] + static_cast<float>(cell % side)) * static_cast<float>(stride);
      numbers[1] = (numbers[1] + static_cast<float>(cell / side)) * static_cast<float>(stride);
      numbers[2] = std::exp(numbers[2]) * static_cast<float>(stride);
      numbers[3] = std::exp(numbers[3]) * static_cast<float>(stride);
    }
  }
}

/// One row as a box, if its best class scores enough.
std::optional<Detection> read_row(const OutputReader& reader, const float* numbers) {
  const float* const scores = numbers + kBoxNumbers + (has_objectness(reader.layout) ? 1 : 0);
  const float* const best = std::max_element(scores, scores + reader.names.size());
  const bool scores_are_conditional =
      reader.layout == NetworkLayout::kYolov5 || reader.layout == NetworkLayout::kYolox;
  const double score = scores_are_conditional ? double(*best) * double(numbers[kBoxNumbers]) : double(*best);
  if (!(score >= reader.score_threshold)) return std::nullopt;
  const double scale = reader.layout == NetworkLayout::kDarknet ? reader.input_px : 1.0;
  const double x = scale * double(numbers[0]), y = scale * double(numbers[1]);
  const double half_width = 0.5 * scale * double(numbers[2]), half_height = 0.5 * scale * double(numbers[3]);
  return Detection{.class_name = reader.names[static_cast<std::size_t>(best - scores)],
                   .score = std::min(score, 1.0),
                   .box = {.x_min = x - half_width,
                           .y_min = y - half_height,
                           .x_max = x + half_width,
                           .y_max = y + half_height}};
}

}  // namespace

std::vector<Detection> read_outputs(const OutputReader& reader, const std::vector<cv::Mat>& outputs,
                                    const std::string& place) {
  std::vector<Detection> detections;
  for (const cv::Mat& output : outputs) {
    std::optional<cv::Mat> rows = as_rows(reader, output);
    if (!rows) {
      throw InputError(place, "puts out " + shape_text(output) + ", which does not fit the layout with " +
                                  std::to_string(reader.names.size()) +
                                  " classes; check detector.layout, detector.names and detector.input_px");
    }
    if (reader.layout == NetworkLayout::kYolox) unfold_grids(*rows, reader.input_px);
    for (int row = 0; row < rows->rows; ++row) {
      std::optional<Detection> detection = read_row(reader, rows->ptr<float>(row));
      if (detection) detections.push_back(std::move(*detection));
    }
  }
  return detections;
}

std::vector<Detection> without_duplicates(std::vector<Detection> detections, double max_overlap) {
  std::stable_sort(detections.begin(), detections.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  std::vector<Detection> kept;
  for (Detection& candidate : detections) {
    const bool duplicate = std::any_of(kept.begin(), kept.end(), [&](const Detection& better) {
      return better.class_name == candidate.class_name && overlap(better.box, candidate.box) > max_overlap;
    });
    if (!duplicate) kept.push_back(std::move(candidate));
  }
  return kept;
}

}  // namespace stillpoint
