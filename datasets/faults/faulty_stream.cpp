// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/faulty_stream.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/types.hpp>

#include "core/base/error.h"
#include "core/types/detection.h"
#include "core/types/frame.h"
#include "core/types/rig.h"
#include "datasets/faults/image_faults.h"
#include "datasets/faults/inertial_faults.h"
#include "datasets/faults/rig_faults.h"
#include "datasets/synthetic/counter_random.h"

namespace stillpoint::datasets {
namespace {

constexpr std::int64_t kAfterSuccessor_ns = 1000;

std::vector<FrameArrival> at_timestamps(std::span<const Timestamp> frame_times) {
  std::vector<FrameArrival> arrivals;
  for (std::size_t i = 0; i < frame_times.size(); ++i) arrivals.push_back({i, frame_times[i]});
  return arrivals;
}

/// Arrivals with a fault of target `kArrival`, which concerns the frames with a timestamp in its active
/// interval:
///
///   frame_late         t <- t + a
///   frame_reordered    with probability a: t <- 1 us after the timestamp of the next frame
///   frame_duplicated   with probability a: also arrives 1 us after the timestamp of the next frame
///
/// a: amount. The last frame of the sequence has no next one and is not changed by the last two.
/// @param arrivals    empty: each frame arrives at its timestamp
/// @param frame_times of the sequence; the first is the start of the schedule
/// @return in order of time
std::vector<FrameArrival> arrivals_with_fault(std::vector<FrameArrival> arrivals, const SensorFault& fault,
                                              std::span<const Timestamp> frame_times) {
  if (arrivals.empty()) arrivals = at_timestamps(frame_times);
  std::vector<FrameArrival> repeated;
  for (FrameArrival& arrival : arrivals) {
    if (!fault.is_active(seconds_between(frame_times.front(), frame_times[arrival.index]))) continue;
    if (fault.kind == FaultKind::kFrameLate) {
      arrival.t = after(arrival.t, fault.amount);
      continue;
    }
    const bool chosen = fault.random(arrival.index).chance(fault.amount);
    if (!chosen || arrival.index + 1 == frame_times.size()) continue;
    const Timestamp later{frame_times[arrival.index + 1].ns + kAfterSuccessor_ns};
    if (fault.kind == FaultKind::kFrameReordered) {
      arrival.t = std::max(arrival.t, later);
    } else {
      repeated.push_back({arrival.index, std::max(arrival.t, later)});
    }
  }
  arrivals.insert(arrivals.end(), repeated.begin(), repeated.end());
  std::ranges::stable_sort(arrivals, {}, &FrameArrival::t);
  return arrivals;
}

constexpr double kScore = 0.9;

Detection false_person(synth::RandomSequence& random, cv::Size image) {
  const double width = image.width * random.uniform(0.1, 0.5);
  const double height = image.height * random.uniform(0.1, 0.5);
  const double x = random.uniform(0.0, image.width - width);
  const double y = random.uniform(0.0, image.height - height);
  return {.class_name = "person",
          .score = kScore,
          .box = {.x_min = x, .y_min = y, .x_max = x + width, .y_max = y + height}};
}

/// The result of a detector for one frame, with a fault of target `kDetections`: while it is active, the set
/// becomes `kNone` or `kLate`, or gets `amount` additional boxes of class "person" at random places, each a
/// tenth to a half of the image wide and high. The places depend on the fault and the time only.
/// @param start time of the first frame
DetectionSet detections_with_fault(DetectionSet set, const SensorFault& fault, Timestamp start,
                                   cv::Size image) {
  if (!fault.is_active(seconds_between(start, set.t))) return set;
  if (fault.kind != FaultKind::kDetectorHallucinating) {
    const bool late = fault.kind == FaultKind::kDetectorLate;
    return {.t = set.t, .state = late ? DetectionState::kLate : DetectionState::kNone, .detections = {}};
  }
  const auto index = static_cast<std::size_t>(set.t.ns - start.ns);
  synth::RandomSequence random = fault.random(index);
  for (int box = 0; box < static_cast<int>(std::lround(fault.amount)); ++box)
    set.detections.push_back(false_person(random, image));
  return set;
}

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

/// Applies change(frame) to the gray image and depth now, and to a deferred color image when it is decoded.
/// @param change treats gray and color images alike
template <class Change>
Frame with_deferred_color(Frame frame, const Change& change) {
  if (frame.color.empty() && frame.decode_color) {
    frame.decode_color = [decode = frame.decode_color, change] {
      Frame color;
      color.gray = decode();
      return change(std::move(color)).gray;
    };
  }
  return change(std::move(frame));
}

/// Displacement of the image center while a camera turns with the angular rate w_c: with the point p_c on the
/// optical axis, dp_c/dt = -w_c x p_c, hence du/dt = -fx w_y, dv/dt = fy w_x.
Eigen::Vector2d displacement_px(const Camera& camera, const Eigen::Vector3d& rate_c, double duration_s) {
  return duration_s * Eigen::Vector2d(-camera.fx * rate_c.y(), camera.fy * rate_c.x());
}

/// Mean angular rate within an interval, or that of the next sample; zero after the last one.
Eigen::Vector3d mean_rate(std::span<const ImuSample> samples, const FaultInterval& interval) {
  auto sample = std::ranges::lower_bound(samples, interval.begin, {}, &ImuSample::t);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (; sample != samples.end() && (count == 0 || sample->t <= interval.end); ++sample, ++count)
    sum += sample->gyro_b;
  return sum / std::max(count, 1);
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
      if (target == FaultTarget::kCalibration) info_.rig = rig_with_fault(info_.rig, fault);
      if (target == FaultTarget::kImu)
        info_.imu = samples_with_fault(std::move(info_.imu), fault, start_, stream_->info().rig.imu_noise);
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
    const auto uses_color = [](const SensorFault& fault) { return fault.kind == FaultKind::kOccluder; };
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
      case FaultKind::kExposureBlur: {
        const Eigen::Vector2d line_px = motion_px(frame.t, fault.amount);
        return with_deferred_color(std::move(frame),
                                   [=](Frame sharp) { return blurred_along(std::move(sharp), line_px); });
      }
      default:
        if (descriptor_of(fault.kind).target == FaultTarget::kDepth)
          return frame_with_fault(std::move(frame), fault, source);
        return with_deferred_color(std::move(frame), [fault, source](Frame original) {
          return frame_with_fault(std::move(original), fault, source);
        });
    }
  }

  /// Motion of the image during an exposure whose middle is at `t`, by the true calibration.
  [[nodiscard]] Eigen::Vector2d motion_px(Timestamp t, double exposure_s) const {
    const Rig& rig = stream_->info().rig;
    const Timestamp middle = after(t, rig.time_offset_s);
    const Eigen::Vector3d rate_b = mean_rate(stream_->info().imu, {.begin = after(middle, -0.5 * exposure_s),
                                                                   .end = after(middle, 0.5 * exposure_s)});
    return displacement_px(rig.camera, rig.T_b_c.q.conjugate() * rate_b, exposure_s);
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
  const bool needs_imu = descriptor.target == FaultTarget::kImu || fault.kind == FaultKind::kExposureBlur ||
                         fault.kind == FaultKind::kRotationError || fault.kind == FaultKind::kLeverError;
  if (needs_imu && info.imu.empty()) reject(" has no inertial data");
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
  faults = expanded_rigs(faults);
  for (const SensorFault& fault : faults) require_target(fault, stream->info());
  return std::make_unique<FaultyStream>(std::move(stream), std::move(faults));
}

}  // namespace stillpoint::datasets
