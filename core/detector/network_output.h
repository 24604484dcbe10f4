// SPDX-License-Identifier: BSD-3-Clause
/// Boxes from the numbers that a detection network puts out, for the usual layouts.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/detector/detector_config.h"
#include "core/types/detection.h"

namespace stillpoint {

/// How the outputs of one network are to be read.
///
/// With C classes, a box is centre x, centre y, width, height, then
///   darknet: in shares of the input, an objectness, C scores (the objectness included); N x (5 + C), any
///            number of outputs (Redmon 2018, as OpenCV's region layer writes it);
///   yolov5:  in px of the input, an objectness, C scores to be multiplied by it; 1 x N x (5 + C);
///   yolov8:  in px of the input, C scores; 1 x (4 + C) x N;
///   yolox:   relative to the cells of grids of stride 8, 16 and 32, sizes as logarithms, otherwise like
///            yolov5 (Ge 2021).
struct OutputReader {
  NetworkLayout layout = NetworkLayout::kDarknet;
  int input_px = 320;              ///< side of the network's input
  std::vector<std::string> names;  ///< of the classes
  double score_threshold = 0.3;
};

/// Boxes in px of the network's input, in the order of the outputs; not suppressed yet.
/// @param place names the network in errors
/// @throws InputError if an output has another shape than the layout and the number of classes demand
[[nodiscard]] std::vector<Detection> read_outputs(const OutputReader& reader,
                                                  const std::vector<cv::Mat>& outputs,
                                                  const std::string& place);

/// Non-maximum suppression class by class: by falling score, a box stays unless it overlaps one that stayed
/// by more than `max_overlap` (IoU).
[[nodiscard]] std::vector<Detection> without_duplicates(std::vector<Detection> detections,
                                                        double max_overlap);

}  // namespace stillpoint
