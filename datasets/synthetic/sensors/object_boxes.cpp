// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sensors/object_boxes.h"

#include <algorithm>
#include <map>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint::synth {
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

/// Markov chain of the miss state of each object.
class MissChain {
 public:
  explicit MissChain(const DetectorModel& model)
      : start_probability_(model.miss_rate / (1.0 - model.miss_rate) / model.burst_frames),
        stop_probability_(1.0 / model.burst_frames) {}

  [[nodiscard]] bool misses(int object, RandomSequence& random) {
    bool& missing = missing_[object];
    if (random.chance(missing ? stop_probability_ : start_probability_)) missing = !missing;
    return missing;
  }

 private:
  double start_probability_, stop_probability_;
  std::map<int, bool> missing_;
};

}  // namespace

std::vector<VisibleObject> visible_objects(const RenderedFrame& frame) {
  std::map<int, VisibleObject> found;
  for (int row = 0; row < frame.height; ++row) {
    for (int column = 0; column < frame.width; ++column) {
      const int object = frame.object[static_cast<std::size_t>(row * frame.width + column)];
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
  for (const auto& [object, visible] : found) objects.push_back(visible);
  return objects;
}

std::vector<Detection> true_detections(std::span<const VisibleObject> visible,
                                       std::span<const Actor> actors) {
  std::vector<Detection> boxes;
  for (const VisibleObject& one : visible) {
    const auto actor =
        std::find_if(actors.begin(), actors.end(), [&](const Actor& a) { return a.object == one.object; });
    if (actor != actors.end()) boxes.push_back({actor->class_name, 1.0, one.box});
  }
  return boxes;
}

std::vector<std::vector<Detection>> simulate_detector(std::span<const std::vector<VisibleObject>> frames,
                                                      const DetectorModel& model, const cv::Size& image,
                                                      std::uint64_t seed) {
  RandomSequence random(random_key(seed, RandomStream::kDetector));
  MissChain chain(model);
  std::vector<std::vector<Detection>> reports;
  for (const std::vector<VisibleObject>& visible : frames) {
    std::vector<Detection>& report = reports.emplace_back();
    for (const VisibleObject& one : visible) {
      const bool detectable = one.object < datasets::kFirstUndetectableObject;
      if (!detectable || one.box.y_max - one.box.y_min < model.min_height_px) continue;
      if (chain.misses(one.object, random)) continue;
      report.push_back({"person", random.uniform(0.5, 0.95), jittered(one.box, model, image, random)});
    }
    if (random.chance(model.false_positive_rate)) report.push_back(false_detection(image, random));
  }
  return reports;
}

}  // namespace stillpoint::synth
