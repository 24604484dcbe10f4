// SPDX-License-Identifier: BSD-3-Clause
/// Neural network detector, on OpenCV DNN, and the decoding of its outputs to boxes. The paper uses YOLOv3
/// (Sec. III-C); any YOLO network with a supported output layout works.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/dnn/dnn.hpp>

#include "core/config/detector_config.h"
#include "core/detector/object_detector.h"
#include "core/types/detection.h"

namespace stillpoint {

/// Output format of a network.
///
/// With C classes and N boxes, a box is (center x, center y, width, height), followed by:
///   darknet: objectness, C scores already multiplied by it; box relative to the input size; N x (5 + C), any
///            number of outputs (Redmon 2018, as written by the region layer of OpenCV);
///   yolov5:  objectness, C scores to be multiplied by it; box in px of the input; 1 x N x (5 + C);
///   yolov8:  C scores; box in px of the input; 1 x (4 + C) x N;
///   yolox:   as yolov5, with x, y relative to a grid cell of stride s and the log of width, height:
///            center = (xy + cell) * s, size = exp(wh) * s, for s = 8, 16, 32 in this order (Ge 2021).
struct DecodeOptions {
  NetworkLayout layout = NetworkLayout::kDarknet;
  int input_px = 320;              ///< side of the network input
  std::vector<std::string> names;  ///< class names
  double score_threshold = 0.3;
};

/// Boxes in px of the network input, in the order of the outputs, before non-maximum suppression.
/// @param source name of the network in error messages
/// @throws InputError if the shape of an output does not match the layout and the number of classes
[[nodiscard]] std::vector<Detection> decode_outputs(const DecodeOptions& options,
                                                    const std::vector<cv::Mat>& outputs,
                                                    const std::string& source);

/// Greedy non-maximum suppression per class: in order of decreasing score, a box is removed if its IoU with a
/// remaining box exceeds `max_iou`.
[[nodiscard]] std::vector<Detection> non_maximum_suppression(std::vector<Detection> detections,
                                                             double max_iou);

/// Preprocessing: Darknet networks get the image stretched to the square input, as in their training; the
/// others get it letterboxed (aspect ratio kept, upper left of a gray square). Channels are BGR in [0, 255]
/// for YOLOX, RGB in [0, 1] for the others.
class NetworkDetector : public ObjectDetector {
 public:
  /// Loads the network and runs it once on an empty image, so that errors occur before the first frame.
  ///
  /// OpenCV silently falls back to its default backend if the requested one is not available; here that is an
  /// error. The number of OpenCV threads, which is global to the process, is that of the config during
  /// inference only.
  /// @throws InputError if a file is missing or invalid, the layout or the number of classes does not match,
  /// the backend is not available, or none of the `dynamic_classes` (unless empty) is among the names
  NetworkDetector(const DetectorConfig& config, std::span<const std::string> dynamic_classes);

  [[nodiscard]] DetectionSet detect(const Frame& frame) override;
  [[nodiscard]] std::string description() const override;
  [[nodiscard]] const DetectorCounters& counters() const override { return counters_; }

 private:
  [[nodiscard]] std::vector<cv::Mat> run(const cv::Mat& input);

  DetectorConfig config_;
  DecodeOptions decode_options_;
  cv::dnn::Net net_;
  std::vector<std::string> output_names_;
  DetectorCounters counters_;
};

}  // namespace stillpoint
