// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sensors/sensor_models.h"

#include <algorithm>
#include <array>
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
  const float x = static_cast<float>(column - camera.cx) / static_cast<float>(camera.fx);
  const float y = static_cast<float>(row - camera.cy) / static_cast<float>(camera.fy);
  const float cosine_squared = 1.0F / (1.0F + x * x + y * y);
  return 1.0F - static_cast<float>(vignetting) * (1.0F - cosine_squared * cosine_squared);
}

}  // namespace

double exposure_gain(const ColorSensor& sensor, double t_s) {
  return std::exp2(sensor.exposure_swing * std::sin(2.0 * std::numbers::pi * t_s / sensor.exposure_period_s));
}

namespace {

/// `std::round` of a value in [0, 2^31), in instructions that process several values.
int rounded(float value) {
  const int whole = static_cast<int>(value);
  return whole + (value - static_cast<float>(whole) >= 0.5F ? 1 : 0);
}

}  // namespace

cv::Mat simulate_color(const RenderedFrame& frame, const Camera& camera, const ColorSensor& sensor,
                       const FrameExposure& exposure) {
  const auto& [gain, noise_key] = exposure;
  cv::Mat image(frame.height, frame.width, CV_8UC3);
  const auto read_variance = static_cast<float>(sensor.read_noise * sensor.read_noise);
  const auto shot_variance = static_cast<float>(sensor.shot_noise);
  const auto frame_gain = static_cast<float>(gain);
  const std::array<float, kNormalQuantiles>& normal = normal_quantiles();
  constexpr std::uint64_t kLast = kNormalQuantiles - 1;
  const auto width = static_cast<std::size_t>(frame.width);
  // One row at a time, of four lanes per pixel: each loop is executed in SIMD instructions.
  std::vector<float> scale(width);
  std::vector<Float4> noise(width), signal(width);
  std::vector<std::uint8_t> values(4 * width);
  for (int row = 0; row < frame.height; ++row) {
    const std::size_t first = static_cast<std::size_t>(row) * width;
    for (int column = 0; column < frame.width; ++column) {
      scale[static_cast<std::size_t>(column)] =
          frame_gain * lens_transmission(camera, sensor.vignetting, row, column);
    }
    for (std::size_t i = 0; i < width; ++i) {
      const std::uint64_t bits = mix_bits(noise_key + first + i);
      noise[i] = Float4{normal[bits & kLast], normal[bits >> 12 & kLast], normal[bits >> 24 & kLast], 0.0F};
      signal[i] = frame.radiance[first + i] * scale[i];
    }
    const float* const light = &signal[0][0];
    const float* const deviate = &noise[0][0];
    for (std::size_t i = 0; i < 4 * width; ++i) {
      const float saturated = std::min(light[i], 1.0F);  // the pixel saturates before read-out
      const float sigma = std::sqrt(read_variance + shot_variance * saturated);
      const float value = std::clamp(saturated + sigma * deviate[i], 0.0F, 1.0F);
      values[i] = static_cast<std::uint8_t>(rounded(255.0F * std::sqrt(value)));
    }
    auto* out = image.ptr<cv::Vec3b>(row);
    for (std::size_t i = 0; i < width; ++i) out[i] = {values[4 * i], values[4 * i + 1], values[4 * i + 2]};
  }
  return image;
}

namespace {

constexpr float kJump = 0.06F;  // relative difference of adjacent depths at an edge
constexpr std::uint64_t kLatticeOffset = 1ULL << 40;
constexpr std::uint64_t kDropoutOffset = 1ULL << 41;

/// Correlated noise of unit variance: bilinear interpolation of white noise on a lattice. Rows of the lattice
/// are interpolated along the image's rows once, for all the rows of pixels between them.
class SmoothNoise {
 public:
  SmoothNoise(int cell_px, const cv::Size& image, std::uint64_t key)
      : cell_(static_cast<std::size_t>(cell_px)),
        width_(static_cast<std::size_t>(image.width)),
        key_(key + kLatticeOffset),
        nodes_(width_ / cell_ + 2),
        upper_(width_),
        lower_(width_) {
    for (std::size_t row = 0; row < cell_; ++row) {
      for (std::size_t column = 0; column < width_; ++column) {
        const float x = fraction(column % cell_), y = fraction(row);
        const float variance = ((1.0F - x) * (1.0F - x) + x * x) * ((1.0F - y) * (1.0F - y) + y * y);
        deviations_.push_back(std::sqrt(variance));
      }
    }
    interpolate(0, lower_);
  }

  /// The noise of a row of pixels; to be called for all rows in turn.
  void row(std::size_t row, std::span<float> out) {
    if (row % cell_ == 0) {
      std::swap(upper_, lower_);
      interpolate(row / cell_ + 1, lower_);
    }
    const float y = fraction(row % cell_);
    const float* const deviations = deviations_.data() + row % cell_ * width_;
    for (std::size_t i = 0; i < width_; ++i)
      out[i] = (upper_[i] * (1.0F - y) + lower_[i] * y) / deviations[i];
  }

 private:
  [[nodiscard]] float fraction(std::size_t in_cell) const {
    return static_cast<float>(in_cell) / static_cast<float>(cell_);
  }

  /// A row of the lattice at the columns of the image.
  void interpolate(std::size_t row, std::vector<float>& out) {
    for (std::size_t column = 0; column < nodes_.size(); ++column)
      nodes_[column] = normal_from_bits(mix_bits(key_ + row * 65536 + column));
    for (std::size_t i = 0; i < width_; ++i) {
      const float x = fraction(i % cell_);
      out[i] = nodes_[i / cell_] * (1.0F - x) + nodes_[i / cell_ + 1] * x;
    }
  }

  std::size_t cell_, width_;
  std::uint64_t key_;
  std::vector<float> nodes_;          ///< of a row of the lattice
  std::vector<float> upper_, lower_;  ///< the two rows of the lattice around a row of pixels
  std::vector<float> deviations_;     ///< of the interpolated value, for the rows of pixels of a cell
};

bool differs(float a, float b) { return std::abs(a - b) > kJump * std::min(a, b); }

/// Marks the pixels of a row of which a 4-neighbor has a different depth.
void mark_edges(const TrueDepth& image, int row, std::span<std::uint8_t> marks) {
  const std::size_t width = marks.size();
  const float* const here = image.depth_m.data() + static_cast<std::size_t>(row) * width;
  const float* const above = row > 0 ? here - width : here;
  const float* const below = row + 1 < image.height ? here + width : here;
  const auto mark = [&](std::size_t i, std::size_t left, std::size_t right) {
    marks[i] = static_cast<std::uint8_t>(differs(above[i], here[i]) | differs(below[i], here[i]) |
                                         differs(here[left], here[i]) | differs(here[right], here[i]));
  };
  const std::size_t last = width - 1;
  mark(0, 0, std::min<std::size_t>(1, last));
  for (std::size_t i = 1; i < last; ++i) mark(i, i - 1, i + 1);
  mark(last, last - std::min<std::size_t>(1, last), last);
}

/// As `rounded`, of a value of any sign below 2^23.
float round_away(float value) {
  const float whole = std::trunc(value);
  return whole + std::copysign(std::abs(value - whole) >= 0.5F ? 1.0F : 0.0F, value);
}

/// Row of a depth image. The member is a buffer.
class DepthRow {
 public:
  explicit DepthRow(std::size_t width) : disparity_(width) {}

  /// @param depth_m true depths
  /// @param noise   of unit variance; NaN where there is no measurement
  void simulate(std::span<const float> depth_m, std::span<const float> noise, const DepthSensor& sensor,
                std::uint16_t* out) {
    const auto focal_baseline = static_cast<float>(sensor.focal_baseline_px_m);
    for (std::size_t i = 0; i < depth_m.size(); ++i) disparity_[i] = focal_baseline / depth_m[i];
    if (sensor.edge_dropout > 0.0) remove_hidden();
    const auto noise_px = static_cast<float>(sensor.noise_per_m * sensor.focal_baseline_px_m);
    for (std::size_t i = 0; i < depth_m.size(); ++i) disparity_[i] += noise[i] * noise_px;
    const auto step_px = static_cast<float>(sensor.disparity_step_px);
    for (std::size_t i = 0; step_px > 0.0F && i < depth_m.size(); ++i)
      disparity_[i] = round_away(disparity_[i] / step_px) * step_px;
    const auto min_m = static_cast<float>(sensor.min_m), max_m = static_cast<float>(sensor.max_m),
               units_per_m = static_cast<float>(sensor.units_per_m);
    for (std::size_t i = 0; i < depth_m.size(); ++i) {
      const float z = focal_baseline / disparity_[i];
      const bool valid = (disparity_[i] > 0.0F) & (z >= min_m) & (z <= max_m);  // not so for NaN
      const float units = valid ? std::min(round_away(z * units_per_m), 65535.0F) : 0.0F;
      out[i] = static_cast<std::uint16_t>(static_cast<int>(units));
    }
  }

 private:
  /// Replaces by NaN what is occluded in the second imager: a closer surface projects to the same column of
  /// its image, at column - fb / z. Where there is no surface, the disparity is infinite, and its depth 0.
  void remove_hidden() {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    float nearest_column = kInfinity;
    for (std::size_t i = disparity_.size(); i-- > 0;) {
      const float in_second = static_cast<float>(i) - disparity_[i];
      const float column = disparity_[i] < kInfinity ? in_second : kInfinity;
      const bool hidden = nearest_column <= column - 1.0F;
      nearest_column = std::min(nearest_column, column);
      disparity_[i] = hidden ? std::numeric_limits<float>::quiet_NaN() : disparity_[i];
    }
  }

  std::vector<float> disparity_;
};

}  // namespace

cv::Mat simulate_depth(const TrueDepth& depth, const DepthSensor& sensor, std::uint64_t noise_key) {
  const auto& [depth_m, width, height] = depth;
  cv::Mat image(height, width, CV_16UC1);
  SmoothNoise smooth(sensor.correlation_px, {width, height}, noise_key);
  const auto smooth_weight = static_cast<float>(sensor.correlated_fraction);
  const float white_weight = std::sqrt(std::max(0.0F, 1.0F - smooth_weight * smooth_weight));
  const auto columns = static_cast<std::size_t>(width);
  const std::array<float, kNormalQuantiles>& normal = normal_quantiles();
  DepthRow simulated(columns);
  std::vector<float> noise(columns);
  std::vector<float> correlated(columns);
  std::vector<std::uint8_t> edges(columns);
  for (int row = 0; row < height; ++row) {
    const std::size_t first = static_cast<std::size_t>(row) * columns;
    smooth.row(static_cast<std::size_t>(row), correlated);
    for (std::size_t i = 0; i < columns; ++i) {
      const float white = normal[mix_bits(noise_key + first + i) & (kNormalQuantiles - 1)];
      noise[i] = white_weight * white + smooth_weight * correlated[i];
    }
    if (sensor.edge_dropout > 0.0) mark_edges(depth, row, edges);
    for (std::size_t i = 0; sensor.edge_dropout > 0.0 && i < columns; ++i) {
      if (edges[i] == 0) continue;
      const double chance =
          static_cast<double>(mix_bits(noise_key + kDropoutOffset + first + i) >> 11) * 0x1.0p-53;
      if (chance < sensor.edge_dropout) noise[i] = std::numeric_limits<float>::quiet_NaN();
    }
    simulated.simulate(depth_m.subspan(first, columns), noise, sensor, image.ptr<std::uint16_t>(row));
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
    const std::uint16_t* const objects = frame.object.data() + std::ptrdiff_t{row} * frame.width;
    if (std::all_of(objects, objects + frame.width, [](std::uint16_t object) { return object == 0; }))
      continue;
    for (int column = 0; column < frame.width; ++column) {
      const int object = objects[column];
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
