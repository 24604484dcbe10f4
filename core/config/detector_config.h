// SPDX-License-Identifier: BSD-3-Clause
/// Settings of the object detector. Paper Sec. II (object detection thread), III-C.
#pragma once

#include <string>
#include <type_traits>

#include "core/base/fields.h"

namespace stillpoint {

enum class DetectorKind { kNone, kRecorded, kNetwork, kSimulated };
constexpr auto enum_names(DetectorKind) {
  return EnumNames<DetectorKind, 4>{{{DetectorKind::kNone, "none"},
                                     {DetectorKind::kRecorded, "recorded"},
                                     {DetectorKind::kNetwork, "network"},
                                     {DetectorKind::kSimulated, "simulated"}}};
}

/// Output layout of a network; see core/detector/network_detector.h.
enum class NetworkLayout { kDarknet, kYolov5, kYolov8, kYolox };
constexpr auto enum_names(NetworkLayout) {
  return EnumNames<NetworkLayout, 4>{{{NetworkLayout::kDarknet, "darknet"},
                                      {NetworkLayout::kYolov5, "yolov5"},
                                      {NetworkLayout::kYolov8, "yolov8"},
                                      {NetworkLayout::kYolox, "yolox"}}};
}

enum class NetworkBackend { kOpencv, kOpenvino, kCuda };
constexpr auto enum_names(NetworkBackend) {
  return EnumNames<NetworkBackend, 3>{{{NetworkBackend::kOpencv, "opencv"},
                                       {NetworkBackend::kOpenvino, "openvino"},
                                       {NetworkBackend::kCuda, "cuda"}}};
}

/// Error model applied to ground truth boxes.
struct SimulatedDetectorConfig {
  double miss_rate = 0.15;           ///< fraction of the frames in which an object is missed
  int burst_frames = 5;              ///< minimum number of consecutive missed frames
  double latency_s = 0.0;            ///< age of the boxes when they are returned
  double jitter_px = 2.0;            ///< standard deviation of the error of each edge
  double false_positive_rate = 0.0;  ///< fraction of the frames with a false detection
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, SimulatedDetectorConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("miss_rate", config.miss_rate, 0.0, 1.0);
  field("burst_frames", config.burst_frames, 1, 1000);
  field("latency_s", config.latency_s, 0.0, 10.0);
  field("jitter_px", config.jitter_px, 0.0, 100.0);
  field("false_positive_rate", config.false_positive_rate, 0.0, 1.0);
}

struct DetectorConfig {
  DetectorKind kind = DetectorKind::kRecorded;
  int every_n_frames = 1;                ///< process every n-th frame only
  double max_time_difference_s = 0.016;  ///< between a frame and its recorded boxes; default: half the
                                         ///< frame interval at 30 Hz
  std::string weights;                   ///< network: .weights (Darknet) or .onnx file
  std::string cfg;                       ///< network: Darknet .cfg file; empty for ONNX
  std::string names;                     ///< text file with one class name per line
  NetworkLayout layout = NetworkLayout::kDarknet;
  NetworkBackend backend = NetworkBackend::kOpencv;  ///< an error if OpenCV was built without it
  int input_px = 320;                                ///< side of the square network input
  double score_threshold = 0.3;
  double nms_threshold = 0.45;  ///< IoU threshold of the non-maximum suppression
  int threads = 1;  ///< of OpenCV during a run: one setting for inference and all other functions of OpenCV
  SimulatedDetectorConfig simulated;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, DetectorConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("kind", config.kind);
  field("every_n_frames", config.every_n_frames, 1, 1000);
  field("max_time_difference_s", config.max_time_difference_s, 0.0, 1.0);
  field("weights", config.weights);
  field("cfg", config.cfg);
  field("names", config.names);
  field("layout", config.layout);
  field("backend", config.backend);
  field("input_px", config.input_px, 32, 2048);
  field("score_threshold", config.score_threshold, 0.0, 1.0);
  field("nms_threshold", config.nms_threshold, 0.0, 1.0);
  field("threads", config.threads, 1, 64);
  field("simulated", config.simulated);
}

}  // namespace stillpoint
