// SPDX-License-Identifier: BSD-3-Clause
/// Neural network detector, on OpenCV DNN. The paper uses YOLOv3 (Sec. III-C); any YOLO network with a
/// supported output layout works.
#pragma once

#include <opencv2/dnn/dnn.hpp>

#include "core/detector/network_output.h"
#include "core/detector/object_detector.h"

namespace stillpoint {

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
