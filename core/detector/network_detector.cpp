// SPDX-License-Identifier: BSD-3-Clause
#include "core/detector/network_detector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base/error.h"
#include "core/detector/object_detector.h"
#include "core/detector/opencv_threads.h"
#include "core/types/detection.h"

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
      const int x = cell % side, y = cell / side;
      float* const values = rows.ptr<float>(row);
      values[0] = (values[0] + static_cast<float>(x)) * static_cast<float>(stride);
      values[1] = (values[1] + static_cast<float>(y)) * static_cast<float>(stride);
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

namespace {

namespace fs = std::filesystem;

constexpr double kPadding = 114.0;  ///< gray value of the letterbox, as in the training of YOLO

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{4} << 30U;
constexpr std::uintmax_t kMaxTextBytes = 16U << 20U;

void require_file(const std::string& key, const std::string& file) {
  if (file.empty()) throw InputError(key, "is not set; it must name a file of the network");
  if (!fs::is_regular_file(file))
    throw InputError(file, "is not a file; " + key + " must name a file of the network");
  if (fs::file_size(file) > kMaxBytes)
    throw InputError(file, "is larger than 4 GB; " + key + " must name a file of the network");
}

/// A text file of the network.
void require_text_file(const std::string& key, const std::string& file) {
  require_file(key, file);
  if (fs::file_size(file) > kMaxTextBytes)
    throw InputError(file, "is larger than 16 MB; " + key + " must name a text file of the network");
}

std::vector<std::string> read_names(const std::string& file) {
  require_text_file("detector.names", file);
  std::ifstream in(file);
  std::vector<std::string> names;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // of UTF-8, which editors of Windows write
  for (std::string line; std::getline(in, line);) {
    if (names.empty() && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (!line.empty()) names.push_back(line);
  }
  if (names.empty()) throw InputError(file, "contains no class names; expected one per line");
  return names;
}

void require_known_class(const DetectorConfig& config, const std::vector<std::string>& names,
                         std::span<const std::string> dynamic_classes) {
  const bool known = std::any_of(
      dynamic_classes.begin(), dynamic_classes.end(),
      [&](const std::string& name) { return std::find(names.begin(), names.end(), name) != names.end(); });
  if (known || dynamic_classes.empty()) return;
  throw InputError(config.names, "contains none of the classes in dynamic.classes; its first class is \"" +
                                     names.front() + "\"");
}

int opencv_backend(NetworkBackend backend) {
  switch (backend) {
    case NetworkBackend::kOpencv:
      return cv::dnn::DNN_BACKEND_OPENCV;
    case NetworkBackend::kOpenvino:
      return cv::dnn::DNN_BACKEND_INFERENCE_ENGINE;
    case NetworkBackend::kCuda:
      return cv::dnn::DNN_BACKEND_CUDA;
  }
  check_failed("a backend of this name exists", __FILE__, __LINE__);
}

int target_of(NetworkBackend backend) {
  return backend == NetworkBackend::kCuda ? cv::dnn::DNN_TARGET_CUDA : cv::dnn::DNN_TARGET_CPU;
}

cv::dnn::Net with_backend(cv::dnn::Net net, NetworkBackend backend) {
  const auto id = static_cast<cv::dnn::Backend>(opencv_backend(backend));
  const std::vector<cv::dnn::Target> targets = cv::dnn::getAvailableTargets(id);
  if (std::find(targets.begin(), targets.end(), target_of(backend)) == targets.end()) {
    throw InputError("detector.backend", "OpenCV was built without it; use \"opencv\"");
  }
  net.setPreferableBackend(id);
  net.setPreferableTarget(target_of(backend));
  return net;
}

/// Silences the OpenCV log: OpenCV also prints the errors that it throws.
class ScopedSilentOpencv {
 public:
  ScopedSilentOpencv() : previous_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~ScopedSilentOpencv() { cv::utils::logging::setLogLevel(previous_); }
  ScopedSilentOpencv(const ScopedSilentOpencv&) = delete;
  ScopedSilentOpencv& operator=(const ScopedSilentOpencv&) = delete;

 private:
  cv::utils::logging::LogLevel previous_;
};

/// Error message of OpenCV without line breaks.
std::string one_line(const cv::Exception& error) {
  std::string text = error.err;
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

cv::dnn::Net load(const DetectorConfig& config) {
  require_file("detector.weights", config.weights);
  const bool darknet = config.layout == NetworkLayout::kDarknet;
  if (darknet) require_text_file("detector.cfg", config.cfg);
  const ScopedSilentOpencv silent;
  try {
    return darknet ? cv::dnn::readNetFromDarknet(config.cfg, config.weights)
                   : cv::dnn::readNetFromONNX(config.weights);
  } catch (const cv::Exception& error) {
    throw InputError(config.weights, "is not a network that OpenCV can read" +
                                         (darknet ? " with " + config.cfg : "") + " (" + one_line(error) +
                                         "); check detector.weights, detector.cfg and detector.layout");
  }
}

/// OpenCV silently fills up a truncated weights file with zeros.
/// @throws InputError if the file contains fewer weights than the Darknet network requires
void require_complete_weights(const cv::dnn::Net& net, const std::string& file) {
  constexpr std::uintmax_t kMinHeaderBytes = 16;
  std::uintmax_t weights = 0;
  for (const cv::String& name : net.getLayerNames()) {
    const cv::Ptr<cv::dnn::Layer> layer = net.getLayer(net.getLayerId(name));
    if (layer->type == "Region") continue;  // its blobs are the anchors from the cfg
    for (const cv::Mat& blob : layer->blobs) weights += blob.total();
  }
  const std::uintmax_t needed = kMinHeaderBytes + weights * sizeof(float);
  if (fs::file_size(file) >= needed) return;
  throw InputError(file, "has " + std::to_string(fs::file_size(file)) + " bytes, detector.cfg requires " +
                             std::to_string(needed) + "; it is truncated or belongs to another network");
}

/// Scale from the image to the network input: input = image * scale.
struct InputScale {
  double x = 1.0;
  double y = 1.0;
};

InputScale input_scale(cv::Size image, const DetectorConfig& config) {
  const double x = static_cast<double>(config.input_px) / image.width;
  const double y = static_cast<double>(config.input_px) / image.height;
  if (config.layout == NetworkLayout::kDarknet) return {x, y};
  return {std::min(x, y), std::min(x, y)};
}

cv::Mat make_blob(const Frame& frame, const InputScale& scale, const DetectorConfig& config) {
  cv::Mat color = color_image(frame);
  if (color.empty()) cv::cvtColor(frame.gray, color, cv::COLOR_GRAY2RGB);
  const cv::Size size(std::min(cvRound(color.cols * scale.x), config.input_px),
                      std::min(cvRound(color.rows * scale.y), config.input_px));
  cv::Mat square(config.input_px, config.input_px, CV_8UC3, cv::Scalar::all(kPadding));
  cv::resize(color, square(cv::Rect({0, 0}, size)), size, 0.0, 0.0, cv::INTER_LINEAR);
  const bool yolox = config.layout == NetworkLayout::kYolox;
  return cv::dnn::blobFromImage(square, yolox ? 1.0 : 1.0 / 255.0, {}, {}, yolox);
}

}  // namespace

NetworkDetector::NetworkDetector(const DetectorConfig& config, std::span<const std::string> dynamic_classes)
    : config_(config),
      decode_options_{.layout = config.layout,
                      .input_px = config.input_px,
                      .names = read_names(config.names),
                      .score_threshold = config.score_threshold},
      net_(load(config)),
      output_names_(net_.getUnconnectedOutLayersNames()) {
  require_known_class(config, decode_options_.names, dynamic_classes);
  if (config.layout == NetworkLayout::kDarknet) require_complete_weights(net_, config.weights);
  net_ = with_backend(net_, config.backend);
  const cv::Mat empty(config.input_px, config.input_px, CV_8UC3, cv::Scalar::all(kPadding));
  static_cast<void>(decode_outputs(decode_options_, run(cv::dnn::blobFromImage(empty)), config.weights));
}

std::vector<cv::Mat> NetworkDetector::run(const cv::Mat& input) {
  std::vector<cv::Mat> outputs;
  const ScopedSilentOpencv silent;
  const ScopedOpencvThreads threads(config_.threads);
  try {
    net_.setInput(input);
    net_.forward(outputs, output_names_);
  } catch (const cv::Exception& error) {
    throw InputError(config_.weights, "cannot be run with an input of " + std::to_string(config_.input_px) +
                                          " px (" + one_line(error) + "); check detector.input_px");
  }
  return outputs;
}

DetectionSet NetworkDetector::detect(const Frame& frame) {
  const InputScale scale = input_scale(frame.gray.size(), config_);
  std::vector<Detection> detections = non_maximum_suppression(
      decode_outputs(decode_options_, run(make_blob(frame, scale, config_)), config_.weights),
      config_.nms_threshold);
  for (Detection& detection : detections) {
    Box& box = detection.box;
    box = {.x_min = box.x_min / scale.x,
           .y_min = box.y_min / scale.y,
           .x_max = box.x_max / scale.x,
           .y_max = box.y_max / scale.y};
  }
  UsableBoxes usable = usable_boxes(std::move(detections), frame.gray.size());
  counters_.add(usable.counters);
  ++counters_.processed;
  return {.t = frame.t, .state = DetectionState::kPresent, .detections = std::move(usable.detections)};
}

std::string NetworkDetector::description() const {
  const char* const where[] = {"cpu", "openvino cpu", "cuda"};
  return "network " + fs::path(config_.weights).filename().string() + ", opencv " CV_VERSION " " +
         where[static_cast<std::size_t>(config_.backend)] + ", " + std::to_string(config_.threads) +
         " thread(s)";
}

}  // namespace stillpoint
