// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/object_boxes.h"

#include <algorithm>
#include <map>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint {
namespace {

/// Edges moved by the detector's jitter, kept in order and within the picture.
Box jittered(const Box& box, const DetectorModel& model, const cv::Size& picture, RandomSequence& random) {
  const double x = model.jitter_share * (box.x_max - box.x_min),
               y = model.jitter_share * (box.y_max - box.y_min);
  Box moved;
  moved.x_min = std::clamp(box.x_min + x * random.normal(), 0.0, picture.width - 3.0);
  moved.y_min = std::clamp(box.y_min + y * random.normal(), 0.0, picture.height - 3.0);
  moved.x_max = std::clamp(box.x_max + x * random.normal(), moved.x_min + 2.0, picture.width - 1.0);
  moved.y_max = std::clamp(box.y_max + y * random.normal(), moved.y_min + 2.0, picture.height - 1.0);
  return moved;
}

Detection false_detection(const cv::Size& picture, RandomSequence& random) {
  const double height = random.uniform(0.2, 0.6) * picture.height, width = random.uniform(0.3, 0.6) * height;
  const double x = random.uniform(0.0, picture.width - width),
               y = random.uniform(0.0, picture.height - height);
  return {"person", random.uniform(0.3, 0.5), {x, y, x + width - 1.0, y + height - 1.0}};
}

/// Whether each object is being missed at present.
class MissChain {
 public:
  explicit MissChain(const DetectorModel& model)
      : begin_(model.miss_share / (1.0 - model.miss_share) / model.burst_frames),
        end_(1.0 / model.burst_frames) {}

  [[nodiscard]] bool misses(int object, RandomSequence& random) {
    bool& missing = missing_[object];
    if (random.chance(missing ? end_ : begin_)) missing = !missing;
    return missing;
  }

 private:
  double begin_, end_;
  std::map<int, bool> missing_;
};

}  // namespace

std::vector<SeenObject> seen_objects(const RenderedFrame& frame) {
  std::map<int, SeenObject> found;
  for (int row = 0; row < frame.height; ++row) {
    for (int column = 0; column < frame.width; ++column) {
      const int object = frame.object[static_cast<std::size_t>(row * frame.width + column)];
      if (object == 0) continue;
      const auto [entry, is_new] = found.try_emplace(object);
      SeenObject& seen = entry->second;
      if (is_new) seen = {object, 0, {column - 0.5, row - 0.5, column + 0.5, row + 0.5}};
      ++seen.pixels;
      seen.box.x_min = std::min(seen.box.x_min, column - 0.5);
      seen.box.x_max = std::max(seen.box.x_max, column + 0.5);
      seen.box.y_max = row + 0.5;
    }
  }
  std::vector<SeenObject> objects;
  for (const auto& [object, seen] : found) objects.push_back(seen);
  return objects;
}

std::vector<Detection> true_detections(std::span<const SeenObject> seen, std::span<const Actor> actors) {
  std::vector<Detection> boxes;
  for (const SeenObject& one : seen) {
    const auto actor =
        std::find_if(actors.begin(), actors.end(), [&](const Actor& a) { return a.object == one.object; });
    if (actor != actors.end()) boxes.push_back({actor->class_name, 1.0, one.box});
  }
  return boxes;
}

std::vector<std::vector<Detection>> simulate_detector(std::span<const std::vector<SeenObject>> frames,
                                                      const DetectorModel& model, int width, int height,
                                                      std::uint64_t seed) {
  RandomSequence random(random_key(seed, RandomStream::kDetector));
  MissChain chain(model);
  const cv::Size picture(width, height);
  std::vector<std::vector<Detection>> reports;
  for (const std::vector<SeenObject>& seen : frames) {
    std::vector<Detection>& report = reports.emplace_back();
    for (const SeenObject& one : seen) {
      const bool known = one.object < kFirstUnknownMover;
      if (!known || one.box.y_max - one.box.y_min < model.min_height_px) continue;
      if (chain.misses(one.object, random)) continue;
      report.push_back({"person", random.uniform(0.5, 0.95), jittered(one.box, model, picture, random)});
    }
    if (random.chance(model.false_share)) report.push_back(false_detection(picture, random));
  }
  return reports;
}

}  // namespace stillpoint
