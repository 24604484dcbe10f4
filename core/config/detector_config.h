// SPDX-License-Identifier: BSD-3-Clause
/// Settings of the object detector. Paper Sec. II (object detection thread), III-C. The field lists explain
/// the keys.
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
  double miss_rate = 0.15;
  int burst_frames = 5;
  double latency_s = 0.0;
  double jitter_px = 2.0;
  double false_positive_rate = 0.0;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, SimulatedDetectorConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("miss_rate", config.miss_rate,
        FieldInfo{"Simulated detector: fraction of the frames in which an object is missed.", "", 0.0, 1.0});
  field("burst_frames", config.burst_frames,
        FieldInfo{"Simulated detector: smallest number of consecutive missed frames.", "frames", 1, 1000});
  field("latency_s", config.latency_s,
        FieldInfo{"Simulated detector: age of the boxes when they are returned.", "s", 0.0, 10.0});
  field("jitter_px", config.jitter_px,
        FieldInfo{"Simulated detector: standard deviation of the error of each edge of a box.", "px", 0.0,
                  100.0});
  field("false_positive_rate", config.false_positive_rate,
        FieldInfo{"Simulated detector: fraction of the frames with a false detection.", "", 0.0, 1.0});
}

struct DetectorConfig {
  DetectorKind kind = DetectorKind::kRecorded;
  int every_n_frames = 1;
  std::string weights;
  std::string cfg;
  std::string names;
  NetworkLayout layout = NetworkLayout::kDarknet;
  NetworkBackend backend = NetworkBackend::kOpencv;
  int input_px = 320;
  double score_threshold = 0.3;
  double nms_threshold = 0.45;
  int threads = 1;
  SimulatedDetectorConfig simulated;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, DetectorConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("kind", config.kind,
        FieldInfo{
            .text = "Source of the boxes: none, a file beside the sequence, a network, or ground truth with "
                    "simulated errors.",
            .paper = "III-C"});
  field("every_n_frames", config.every_n_frames,
        FieldInfo{"Boxes are detected in every n-th frame only.", "frames", 1, 1000});
  field("weights", config.weights,
        FieldInfo{.text = "Network: the .weights (Darknet) or .onnx file.", .paper = "III-C"});
  field("cfg", config.cfg, FieldInfo{.text = "Network: the .cfg file of Darknet; empty for ONNX."});
  field("names", config.names, FieldInfo{.text = "Network: a text file with one class name per line."});
  field("layout", config.layout, FieldInfo{.text = "Network: the layout of its output."});
  field("backend", config.backend,
        FieldInfo{.text = "Network: the library or processor that computes it; an error if OpenCV was built "
                          "without it."});
  field("input_px", config.input_px, FieldInfo{"Network: side of its square input.", "px", 32, 2048});
  field("score_threshold", config.score_threshold,
        FieldInfo{"Network: smallest score of a box.", "", 0.0, 1.0});
  field("nms_threshold", config.nms_threshold,
        FieldInfo{"Network: overlap (IoU) above which the box with the lower score is suppressed.", "", 0.0,
                  1.0});
  field("threads", config.threads,
        FieldInfo{"Threads of OpenCV during a run, for the network and for all other functions of OpenCV.",
                  "", 1, 64});
  field("simulated", config.simulated);
}

}  // namespace stillpoint
