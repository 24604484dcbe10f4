// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sensors/sensor_models.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint::synth {
namespace {

/// Vignetting factor v(theta) at a pixel.
float lens_transmission(const Camera& camera, double vignetting, int row, int column) {
  const double x = (column - camera.cx) / camera.fx, y = (row - camera.cy) / camera.fy;
  const double cosine_squared = 1.0 / (1.0 + x * x + y * y);
  return static_cast<float>(1.0 - vignetting * (1.0 - cosine_squared * cosine_squared));
}

}  // namespace

double exposure_gain(const ColorSensor& sensor, double t_s) {
  return std::exp2(sensor.exposure_swing * std::sin(2.0 * std::numbers::pi * t_s / sensor.exposure_period_s));
}

cv::Mat simulate_color(const RenderedFrame& frame, const Camera& camera, const ColorSensor& sensor,
                       const FrameExposure& exposure) {
  const auto& [gain, noise_key] = exposure;
  cv::Mat image(frame.height, frame.width, CV_8UC3);
  const auto read_variance = static_cast<float>(sensor.read_noise * sensor.read_noise);
  const auto shot_variance = static_cast<float>(sensor.shot_noise);
  std::size_t pixel = 0;
  for (int row = 0; row < frame.height; ++row) {
    auto* out = image.ptr<cv::Vec3b>(row);
    for (int column = 0; column < frame.width; ++column, ++pixel) {
      const float scale =
          static_cast<float>(gain) * lens_transmission(camera, sensor.vignetting, row, column);
      const Float4 light = frame.radiance[pixel] * scale;
      std::uint64_t bits = mix_bits(noise_key + pixel);
      for (int channel = 0; channel < 3; ++channel, bits >>= 12) {
        const float signal = std::min(light[channel], 1.0F);  // the pixel saturates before read-out
        const float sigma = std::sqrt(read_variance + shot_variance * signal);
        const float value = std::clamp(signal + sigma * normal_from_bits(bits), 0.0F, 1.0F);
        out[column][channel] = static_cast<std::uint8_t>(std::lround(255.0F * std::sqrt(value)));
      }
    }
  }
  return image;
}

namespace {

constexpr float kJump = 0.06F;  // relative difference of adjacent depths at an edge
constexpr std::uint64_t kLatticeOffset = 1ULL << 40;
constexpr std::uint64_t kDropoutOffset = 1ULL << 41;

/// Correlated noise of unit variance: bilinear interpolation of white noise on a lattice.
class SmoothNoise {
 public:
  SmoothNoise(int cell_px, std::uint64_t key) : cell_(cell_px), key_(key) {}

  [[nodiscard]] float at(int row, int column) const {
    const float x = static_cast<float>(column % cell_) / static_cast<float>(cell_);
    const float y = static_cast<float>(row % cell_) / static_cast<float>(cell_);
    const int left = column / cell_, top = row / cell_;
    const float upper = node(top, left) * (1.0F - x) + node(top, left + 1) * x;
    const float lower = node(top + 1, left) * (1.0F - x) + node(top + 1, left + 1) * x;
    const float variance = ((1.0F - x) * (1.0F - x) + x * x) * ((1.0F - y) * (1.0F - y) + y * y);
    return (upper * (1.0F - y) + lower * y) / std::sqrt(variance);
  }

 private:
  [[nodiscard]] float node(int row, int column) const {
    return normal_from_bits(
        mix_bits(key_ + kLatticeOffset + static_cast<std::uint64_t>(row * 65536 + column)));
  }
  int cell_;
  std::uint64_t key_;
};

bool differs(float a, float b) { return std::abs(a - b) > kJump * std::min(a, b); }

/// Whether a 4-neighbor has a different depth.
bool at_edge(const TrueDepth& image, int row, int column) {
  const int width = image.width, height = image.height;
  const auto depth = [&image](int y, int x) {
    return image.depth_m[static_cast<std::size_t>(std::ptrdiff_t{y} * image.width + x)];
  };
  const float here = depth(row, column);
  return (column > 0 && differs(depth(row, column - 1), here)) ||
         (column + 1 < width && differs(depth(row, column + 1), here)) ||
         (row > 0 && differs(depth(row - 1, column), here)) ||
         (row + 1 < height && differs(depth(row + 1, column), here));
}

/// Pixels of one row that are occluded in the second imager: a closer surface projects to the same column of
/// its image, at column - fb / z.
std::vector<bool> stereo_shadow(const float* depth_m, int width, double focal_baseline) {
  std::vector<bool> hidden(static_cast<std::size_t>(width));
  double nearest_column = std::numeric_limits<double>::infinity();
  for (int column = width - 1; column >= 0; --column) {
    if (depth_m[column] <= 0.0F) continue;
    const double column_in_second = column - focal_baseline / static_cast<double>(depth_m[column]);
    hidden[static_cast<std::size_t>(column)] = nearest_column <= column_in_second - 1.0;
    nearest_column = std::min(nearest_column, column_in_second);
  }
  return hidden;
}

std::uint16_t depth_reading(double depth_m, double noise, const DepthSensor& sensor) {
  double disparity = sensor.focal_baseline_px_m / depth_m;
  disparity += noise * sensor.noise_per_m * sensor.focal_baseline_px_m;
  if (sensor.disparity_step_px > 0.0) {
    disparity = std::round(disparity / sensor.disparity_step_px) * sensor.disparity_step_px;
  }
  if (disparity <= 0.0) return 0;
  const double z = sensor.focal_baseline_px_m / disparity;
  if (z < sensor.min_m || z > sensor.max_m) return 0;
  return static_cast<std::uint16_t>(std::min(std::lround(z * sensor.units_per_m), 65535L));
}

}  // namespace

cv::Mat simulate_depth(const TrueDepth& depth, const DepthSensor& sensor, std::uint64_t noise_key) {
  const auto& [depth_m, width, height] = depth;
  cv::Mat image = cv::Mat::zeros(height, width, CV_16UC1);
  const SmoothNoise smooth(sensor.correlation_px, noise_key);
  const auto smooth_weight = static_cast<float>(sensor.correlated_fraction);
  const float white_weight = std::sqrt(std::max(0.0F, 1.0F - smooth_weight * smooth_weight));
  std::size_t pixel = 0;
  for (int row = 0; row < height; ++row) {
    const std::vector<bool> hidden =
        stereo_shadow(depth_m.data() + std::ptrdiff_t{row} * width, width,
                      sensor.edge_dropout > 0.0 ? sensor.focal_baseline_px_m : 0.0);
    for (int column = 0; column < width; ++column, ++pixel) {
      if (depth_m[pixel] <= 0.0F || hidden[static_cast<std::size_t>(column)]) continue;
      const std::uint64_t bits = mix_bits(noise_key + pixel);
      const double chance =
          static_cast<double>(mix_bits(noise_key + kDropoutOffset + pixel) >> 11) * 0x1.0p-53;
      if (chance < sensor.edge_dropout && at_edge(depth, row, column)) continue;
      const float noise = smooth_weight * smooth.at(row, column) + white_weight * normal_from_bits(bits);
      image.at<std::uint16_t>(row, column) =
          depth_reading(static_cast<double>(depth_m[pixel]), static_cast<double>(noise), sensor);
    }
  }
  return image;
}

namespace {

/// Box with jittered edges; min < max and inside the image.
Box jittered(const Box& box, const DetectorModel& model, const cv::Size& image, RandomSequence& random) {
  const double x = model.jitter_ratio * (box.x_max - box.x_min),
               y = model.jitter_ratio * (box.y_max - box.y_min);
  Box result;
  result.x_min = std::clamp(box.x_min + x * random.normal(), 0.0, image.width - 3.0);
  result.y_min = std::clamp(box.y_min + y * random.normal(), 0.0, image.height - 3.0);
  result.x_max = std::clamp(box.x_max + x * random.normal(), result.x_min + 2.0, image.width - 1.0);
  result.y_max = std::clamp(box.y_max + y * random.normal(), result.y_min + 2.0, image.height - 1.0);
  return result;
}

Detection false_detection(const cv::Size& image, RandomSequence& random) {
  const double height = random.uniform(0.2, 0.6) * image.height, width = random.uniform(0.3, 0.6) * height;
  const double x = random.uniform(0.0, image.width - width), y = random.uniform(0.0, image.height - height);
  return {"person", random.uniform(0.3, 0.5), {x, y, x + width - 1.0, y + height - 1.0}};
}

}  // namespace

std::vector<VisibleObject> visible_objects(const RenderedFrame& frame) {
  std::map<int, VisibleObject> found;
  for (int row = 0; row < frame.height; ++row) {
    for (int column = 0; column < frame.width; ++column) {
      const int object = frame.object[static_cast<std::size_t>(std::ptrdiff_t{row} * frame.width + column)];
      if (object == 0) continue;
      const auto [entry, is_new] = found.try_emplace(object);
      VisibleObject& visible = entry->second;
      if (is_new) visible = {object, 0, {column - 0.5, row - 0.5, column + 0.5, row + 0.5}};
      ++visible.pixels;
      visible.box.x_min = std::min(visible.box.x_min, column - 0.5);
      visible.box.x_max = std::max(visible.box.x_max, column + 0.5);
      visible.box.y_max = row + 0.5;
    }
  }
  std::vector<VisibleObject> objects;
  objects.reserve(found.size());
  for (const auto& [object, visible] : found) objects.push_back(visible);
  return objects;
}

std::vector<Detection> true_detections(std::span<const VisibleObject> visible, const ObjectClasses& classes) {
  std::vector<Detection> boxes;
  for (const VisibleObject& one : visible) {
    const auto found = classes.find(one.object);
    if (found != classes.end()) boxes.push_back({found->second, 1.0, one.box});
  }
  return boxes;
}

SimulatedPersonDetector::SimulatedPersonDetector(const DetectorModel& model, const cv::Size& image,
                                                 std::uint64_t seed)
    : model_(model), image_(image), random_(random_key(seed, RandomStream::kDetector)) {}

std::vector<Detection> SimulatedPersonDetector::detect(std::span<const VisibleObject> visible) {
  std::vector<Detection> report;
  for (const VisibleObject& one : visible) {
    const bool detectable = one.object < datasets::kFirstUndetectableObject;
    if (!detectable || one.box.y_max - one.box.y_min < model_.min_height_px) continue;
    if (misses(one.object)) continue;
    report.push_back({"person", random_.uniform(0.5, 0.95), jittered(one.box, model_, image_, random_)});
  }
  if (random_.chance(model_.false_positive_rate)) report.push_back(false_detection(image_, random_));
  return report;
}

bool SimulatedPersonDetector::misses(int object) {
  const double start_probability = model_.miss_rate / (1.0 - model_.miss_rate) / model_.burst_frames;
  bool& missing = missing_[object];
  if (random_.chance(missing ? 1.0 / model_.burst_frames : start_probability)) missing = !missing;
  return missing;
}

}  // namespace stillpoint::synth
