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

/// How a network writes its boxes; see core/detector/network_output.h.
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

/// What is done to true boxes to make them like a detector's.
struct SimulatedDetectorConfig {
  double miss_rate = 0.15;           ///< share of an object's pictures in which it is missed
  int burst_frames = 5;              ///< a miss lasts at least so many pictures
  double latency_s = 0.0;            ///< the boxes are this old when they come
  double jitter_px = 2.0;            ///< standard deviation of each edge
  double false_positive_rate = 0.0;  ///< share of pictures with a person that is not there
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
  int every_n_frames = 1;                ///< looks at each n-th picture only
  double max_time_difference_s = 0.016;  ///< recorded boxes of that much another time are a picture's: half
                                         ///< a frame at 30 Hz
  std::string weights;                   ///< of the network: a .weights file, or a .onnx file
  std::string cfg;                       ///< Darknet's description of the network; empty for ONNX
  std::string names;                     ///< its classes, a line each
  NetworkLayout layout = NetworkLayout::kDarknet;
  NetworkBackend backend = NetworkBackend::kOpencv;  ///< refused where OpenCV was built without it
  int input_px = 320;                                ///< side of the square picture that the network takes
  double score_threshold = 0.3;
  double nms_threshold = 0.45;  ///< of two boxes of a class that overlap (IoU) more, the better stays
  int threads = 1;              ///< of the network; OpenCV has one number for the whole program
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
