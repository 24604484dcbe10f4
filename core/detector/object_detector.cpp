// SPDX-License-Identifier: BSD-3-Clause
#include "core/detector/object_detector.h"

#include "core/base/error.h"
#include "core/detector/network_detector.h"
#include "core/detector/playback_detectors.h"
#include "core/types/detection.h"

namespace stillpoint {
namespace {

/// Null detector: processes no frame.
class NoDetector final : public ObjectDetector {
 public:
  [[nodiscard]] DetectionSet detect(const Frame& frame) override {
    ++counters_.skipped;
    return {.t = frame.t, .state = DetectionState::kNone, .detections = {}};
  }
  [[nodiscard]] std::string description() const override { return "none"; }
  [[nodiscard]] const DetectorCounters& counters() const override { return counters_; }

 private:
  DetectorCounters counters_;
};

/// Forwards frames whose id is a multiple of n to another detector, and skips the others.
class SparseDetector final : public ObjectDetector {
 public:
  /// @param every_n at least 1
  SparseDetector(std::unique_ptr<ObjectDetector> detector, int every_n)
      : detector_(std::move(detector)), every_n_(every_n) {}

  [[nodiscard]] DetectionSet detect(const Frame& frame) override {
    if (frame.id % every_n_ == 0) {
      DetectionSet found = detector_->detect(frame);
      counters_ = detector_->counters();
      counters_.skipped += skipped_;
      return found;
    }
    ++skipped_;
    ++counters_.skipped;
    return {.t = frame.t, .state = DetectionState::kNone, .detections = {}};
  }
  [[nodiscard]] std::string description() const override {
    return detector_->description() + ", every " + std::to_string(every_n_) + " frames";
  }
  [[nodiscard]] const DetectorCounters& counters() const override { return counters_; }

 private:
  std::unique_ptr<ObjectDetector> detector_;
  int every_n_;
  std::int64_t skipped_ = 0;
  DetectorCounters counters_;
};

/// Another detector with changed results.
class ChangedDetector final : public ObjectDetector {
 public:
  ChangedDetector(std::unique_ptr<ObjectDetector> detector, std::function<DetectionSet(DetectionSet)> change)
      : detector_(std::move(detector)), change_(std::move(change)) {}

  [[nodiscard]] DetectionSet detect(const Frame& frame) override { return change_(detector_->detect(frame)); }
  [[nodiscard]] std::string description() const override {
    return detector_->description() + ", with injected faults";
  }
  [[nodiscard]] const DetectorCounters& counters() const override { return detector_->counters(); }

 private:
  std::unique_ptr<ObjectDetector> detector_;
  std::function<DetectionSet(DetectionSet)> change_;
};

std::unique_ptr<ObjectDetector> make_for_every_frame(const DetectorConfig& config,
                                                     const DetectorInput& input) {
  switch (config.kind) {
    case DetectorKind::kNone:
      return std::make_unique<NoDetector>();
    case DetectorKind::kRecorded:
      return std::make_unique<RecordedDetector>(input.boxes, kMaxDetectionOffset_s);
    case DetectorKind::kNetwork:
      return std::make_unique<NetworkDetector>(config, input.dynamic_classes);
    case DetectorKind::kSimulated:
      return std::make_unique<SimulatedDetector>(input.boxes, config, input.seed);
  }
  check_failed("a detector of this kind exists", __FILE__, __LINE__);
}

}  // namespace

std::unique_ptr<ObjectDetector> make_object_detector(const DetectorConfig& config,
                                                     const DetectorInput& input) {
  std::unique_ptr<ObjectDetector> detector = make_for_every_frame(config, input);
  const bool computes = config.kind == DetectorKind::kNetwork || config.kind == DetectorKind::kSimulated;
  if (computes && input.change)
    detector = std::make_unique<ChangedDetector>(std::move(detector), input.change);
  if (config.every_n_frames == 1) return detector;
  return std::make_unique<SparseDetector>(std::move(detector), config.every_n_frames);
}

UsableBoxes usable_boxes(std::vector<Detection> detections, cv::Size image_size) {
  const Box image{
      .x_min = 0.0, .y_min = 0.0, .x_max = image_size.width - 1.0, .y_max = image_size.height - 1.0};
  UsableBoxes usable;
  for (Detection& detection : detections) {
    const Box inside = intersection(detection.box, image);
    if (!has_area(detection.box) || !has_area(inside)) {
      ++usable.counters.rejected;
      continue;
    }
    if (inside != detection.box) ++usable.counters.clipped;
    detection.box = inside;
    usable.detections.push_back(std::move(detection));
  }
  usable.counters.boxes = static_cast<std::int64_t>(usable.detections.size());
  return usable;
}

void require_increasing(std::span<const DetectionSet> sets, const std::string& source) {
  for (std::size_t i = 1; i < sets.size(); ++i) {
    if (sets[i].t > sets[i - 1].t) continue;
    throw InputError(source, "set " + std::to_string(i) + " at " + std::to_string(to_seconds(sets[i].t)) +
                                 " s is not later than the previous one; sort the boxes by time");
  }
}

}  // namespace stillpoint
