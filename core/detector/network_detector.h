// SPDX-License-Identifier: BSD-3-Clause
/// A detection network, run by OpenCV. The paper uses YOLOv3 (Sec. III-C); any YOLO of a known layout does.
#pragma once

#include <opencv2/dnn/dnn.hpp>

#include "core/detector/network_output.h"
#include "core/detector/object_detector.h"

namespace stillpoint {

/// Darknet networks see the picture stretched to their square input, as they were trained; the others see it
/// with its proportions kept, at the upper left of a gray square. YOLOX takes blue-green-red of 0 to 255,
/// the others red-green-blue of 0 to 1.
class NetworkDetector : public ObjectDetector {
 public:
  /// Loads the network and runs it once on an empty picture, so that faults show before the first frame.
  ///
  /// OpenCV falls back to its own code in silence where a backend is missing; here that is an error. It has
  /// one number of threads for the whole program, which this sets.
  /// @throws InputError if a file is missing or broken, layout or number of classes do not fit, the backend
  /// is not there, or none of the `dynamic_classes` (unless they are empty) is among the names
  NetworkDetector(const DetectorConfig& config, std::span<const std::string> dynamic_classes);

  [[nodiscard]] DetectionSet detect(const Frame& frame) override;
  [[nodiscard]] std::string description() const override;
  [[nodiscard]] const DetectorCounters& counters() const override { return counters_; }

 private:
  [[nodiscard]] std::vector<cv::Mat> run(const cv::Mat& input);

  DetectorConfig config_;
  OutputReader reader_;
  cv::dnn::Net net_;
  std::vector<std::string> output_names_;
  DetectorCounters counters_;
};

}  // namespace stillpoint
