// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/faulty_stream.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/faults/arrival_faults.h"
#include "datasets/faults/detection_faults.h"
#include "datasets/faults/image_faults.h"
#include "datasets/faults/imu_faults.h"
#include "datasets/faults/occluder.h"
#include "datasets/synthetic/counter_random.h"

namespace stillpoint::datasets {
namespace {

bool is_dropped(const SensorFault& fault, double elapsed_s, std::size_t index) {
  if (fault.kind != FaultKind::kDropped || !fault.is_active(elapsed_s)) return false;
  return fault.random(index).chance(fault.amount);
}

/// The frame with its color image, to which a fault can be applied.
Frame with_color(Frame frame) {
  frame.color = color_image(frame);
  frame.decode_color = nullptr;
  return frame;
}

class FaultyStream final : public SensorStream {
 public:
  FaultyStream(std::unique_ptr<SensorStream> stream, std::vector<SensorFault> faults)
      : stream_(std::move(stream)), faults_(std::move(faults)), info_(stream_->info()) {
    start_ = info_.frame_times.front();
    keep_frames();
    const cv::Size image(info_.rig.camera.width, info_.rig.camera.height);
    for (const SensorFault& fault : faults_) {
      if (fault.kind == FaultKind::kOccluder)
        occluders_.emplace(&fault, Occluder(image, fault.amount, fault.seed));
      const FaultTarget target = descriptor_of(fault.kind).target;
      if (target == FaultTarget::kImu) info_.imu = samples_with_fault(std::move(info_.imu), fault, start_);
      if (target == FaultTarget::kDetections) add_detection_fault(fault, image);
      if (target == FaultTarget::kArrival)
        info_.arrivals = arrivals_with_fault(std::move(info_.arrivals), fault, info_.frame_times);
      info_.notes.push_back("injected fault: " + fault_text(fault));
    }
  }

  [[nodiscard]] const SequenceInfo& info() const override { return info_; }

  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    const std::size_t source = frames_.at(index);
    Frame frame = stream_->load_frame(source);
    const double elapsed_s = seconds_between(start_, frame.t);
    for (const SensorFault& fault : faults_) {
      if (!fault.is_active(elapsed_s)) continue;
      const FaultTarget target = descriptor_of(fault.kind).target;
      if (target == FaultTarget::kImages || target == FaultTarget::kDepth)
        frame = faulty(std::move(frame), fault, source);
    }
    frame.id = static_cast<std::int64_t>(index);
    return frame;
  }

  [[nodiscard]] bool frames_are_cached() const override {
    const auto uses_color = [](const SensorFault& fault) {
      return descriptor_of(fault.kind).target == FaultTarget::kImages;
    };
    return stream_->frames_are_cached() && std::none_of(faults_.begin(), faults_.end(), uses_color);
  }

  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t index) const override {
    return stream_->load_labels(frames_.at(index));
  }

 private:
  /// Changes recorded boxes, and later the results of a detector.
  void add_detection_fault(const SensorFault& fault, cv::Size image) {
    for (DetectionSet& set : info_.detections)
      set = detections_with_fault(std::move(set), fault, start_, image);
    info_.change_detections = [before = info_.change_detections, fault, start = start_,
                               image](DetectionSet set) {
      if (before) set = before(std::move(set));
      return detections_with_fault(std::move(set), fault, start, image);
    };
  }

  /// Lists the frames that are not dropped.
  void keep_frames() {
    info_.frame_times.clear();
    const std::vector<Timestamp>& times = stream_->info().frame_times;
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double elapsed_s = seconds_between(start_, times[i]);
      if (std::any_of(faults_.begin(), faults_.end(),
                      [&](const SensorFault& fault) { return is_dropped(fault, elapsed_s, i); })) {
        continue;
      }
      frames_.push_back(i);
      info_.frame_times.push_back(times[i]);
    }
    if (frames_.empty()) throw InputError("--fault", "all frames are dropped");
  }

  [[nodiscard]] Frame faulty(Frame frame, const SensorFault& fault, std::size_t source) const {
    switch (fault.kind) {
      case FaultKind::kDropped:
        return frame;
      case FaultKind::kFrozen: {
        const Frame frozen = stream_->load_frame(last_frame_before(fault, frame.t));
        frame.gray = frozen.gray;
        frame.color = frozen.color;
        frame.decode_color = frozen.decode_color;
        frame.depth = frozen.depth;
        return frame;
      }
      case FaultKind::kDepthPrevious:
        if (source > 0) frame.depth = stream_->load_frame(source - 1).depth;
        return frame;
      case FaultKind::kOccluder:
        return occluders_.at(&fault).in_front_of(with_color(std::move(frame)), source);
      default:
        if (descriptor_of(fault.kind).target == FaultTarget::kImages) frame = with_color(std::move(frame));
        return frame_with_fault(std::move(frame), fault, source);
    }
  }

  /// Index of the last frame before the current interval of the fault; 0 if there is none.
  [[nodiscard]] std::size_t last_frame_before(const SensorFault& fault, Timestamp t) const {
    const double onset_s = fault.onset_s(seconds_between(start_, t));
    const std::vector<Timestamp>& times = stream_->info().frame_times;
    const auto first_active = std::partition_point(times.begin(), times.end(), [&](Timestamp stamp) {
      return seconds_between(start_, stamp) < onset_s;
    });
    return first_active == times.begin() ? 0 : static_cast<std::size_t>(first_active - times.begin() - 1);
  }

  std::unique_ptr<SensorStream> stream_;
  const std::vector<SensorFault> faults_;
  std::map<const SensorFault*, Occluder> occluders_;  ///< of elements of `faults_`
  SequenceInfo info_;
  Timestamp start_;
  std::vector<std::size_t> frames_;  ///< source index of each remaining frame
};

void require_target(const SensorFault& fault, const SequenceInfo& info) {
  const FaultDescriptor& descriptor = descriptor_of(fault.kind);
  const auto reject = [&](const char* problem) {
    throw InputError(fmt::format("fault \"{}\"", descriptor.name), info.folder.string() + problem);
  };
  if (descriptor.target == FaultTarget::kImu && info.imu.empty()) reject(" has no inertial data");
}

}  // namespace

std::vector<FaultInterval> fault_intervals(const SensorFault& fault, Timestamp first, Timestamp last) {
  std::vector<FaultInterval> intervals;
  for (double start_s = fault.start_s; after(first, start_s) <= last; start_s += fault.every_s) {
    intervals.push_back({.begin = after(first, start_s), .end = after(first, start_s + fault.duration_s)});
    if (fault.every_s <= 0.0) break;
  }
  return intervals;
}

std::unique_ptr<SensorStream> with_faults(std::unique_ptr<SensorStream> stream,
                                          std::vector<SensorFault> faults) {
  if (faults.empty()) return stream;
  for (const SensorFault& fault : faults) require_target(fault, stream->info());
  return std::make_unique<FaultyStream>(std::move(stream), std::move(faults));
}

}  // namespace stillpoint::datasets
