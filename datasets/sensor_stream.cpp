// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sensor_stream.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

/// The frames first, first + step, first + 2 step, ... of a stream.
class PartialStream final : public SensorStream {
 public:
  PartialStream(std::unique_ptr<SensorStream> stream, std::size_t first, std::size_t step)
      : stream_(std::move(stream)), info_(stream_->info()), first_(first), step_(step) {
    info_.frame_times.clear();
    const std::vector<Timestamp>& times = stream_->info().frame_times;
    for (std::size_t i = first; i < times.size(); i += step) info_.frame_times.push_back(times[i]);
  }

  /// Removes IMU samples, boxes and true poses.
  void remove_before(Timestamp start) {
    const auto is_early = [&](const auto& item) { return item.t < start; };
    std::erase_if(info_.imu, is_early);
    std::erase_if(info_.ground_truth.trajectory.poses, is_early);
    std::erase_if(info_.detections, is_early);
    std::erase_if(info_.true_boxes, is_early);
  }

  /// Removes the other frames, and what follows them.
  void keep_first(std::size_t count) {
    info_.frame_times.resize(count);
    const auto remove_after = [last = info_.frame_times.back()](auto& items, double margin_s) {
      std::erase_if(items, [&](const auto& item) { return item.t > after(last, margin_s); });
    };
    constexpr double kAssociation_s = 0.02;  // a true pose may be slightly later than its frame
    constexpr double kInterpolation_s = 0.1;
    remove_after(info_.imu, kInterpolation_s);
    remove_after(info_.ground_truth.trajectory.poses, kAssociation_s);
    remove_after(info_.detections, kAssociation_s);
    remove_after(info_.true_boxes, kAssociation_s);
  }

  [[nodiscard]] const SequenceInfo& info() const override { return info_; }
  void note(std::string text) { info_.notes.push_back(std::move(text)); }

  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    Frame frame = stream_->load_frame(first_ + index * step_);
    frame.id = static_cast<std::int64_t>(index);
    return frame;
  }

  [[nodiscard]] bool frames_are_cached() const override { return stream_->frames_are_cached(); }

  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t index) const override {
    return stream_->load_labels(first_ + index * step_);
  }

 private:
  std::unique_ptr<SensorStream> stream_;
  SequenceInfo info_;
  std::size_t first_, step_;
};

}  // namespace

std::unique_ptr<SensorStream> start_at(std::unique_ptr<SensorStream> stream, double start_s) {
  if (start_s == 0.0 || stream->info().frame_times.empty()) return stream;
  const std::vector<Timestamp>& times = stream->info().frame_times;
  const Timestamp start = after(times.front(), start_s);
  const auto first = std::ranges::lower_bound(times, start);
  if (first == times.end()) {
    throw InputError("--start",
                     fmt::format("{:g} s is past the end of {}, whose last frame is at {:.2f} s; "
                                 "use a smaller value",
                                 start_s, stream->info().name, seconds_between(times.front(), times.back())));
  }
  const auto skipped = static_cast<std::size_t>(first - times.begin());
  auto late = std::make_unique<PartialStream>(std::move(stream), skipped, 1);
  late->remove_before(start);
  late->note(fmt::format("begins {:g} s after the first frame of the sequence, without its {} first frames",
                         start_s, skipped));
  return late;
}

std::unique_ptr<SensorStream> every_nth_frame(std::unique_ptr<SensorStream> stream, int step) {
  if (step < 1) throw InputError("--every", fmt::format("must be 1 or more, not {}", step));
  if (step == 1) return stream;
  const std::size_t all = stream->info().frame_times.size();
  auto part = std::make_unique<PartialStream>(std::move(stream), 0, static_cast<std::size_t>(step));
  part->note(fmt::format("1 of {} frames is played: {} of {}", step, part->info().frame_times.size(), all));
  return part;
}

std::unique_ptr<SensorStream> first_frames(std::unique_ptr<SensorStream> stream, std::size_t count) {
  const std::size_t all = stream->info().frame_times.size();
  if (count == 0 || count >= all) return stream;
  auto part = std::make_unique<PartialStream>(std::move(stream), 0, 1);
  part->keep_first(count);
  part->note(fmt::format("the first {} of {} frames are played", count, all));
  return part;
}

namespace {

/// Time span of one pass; consecutive passes share their boundary time.
struct Pass {
  Timestamp first;  ///< first frame time of the sequence
  Timestamp last;   ///< last frame time of the sequence
  int number = 0;   ///< from 0; odd passes run backwards

  [[nodiscard]] bool backwards() const { return number % 2 == 1; }
  /// Playback time of sequence time `t`.
  [[nodiscard]] Timestamp playback_time(Timestamp t) const {
    const std::int64_t elapsed_ns = backwards() ? last.ns - t.ns : t.ns - first.ns;
    return {.ns = first.ns + number * (last.ns - first.ns) + elapsed_ns};
  }
};

/// Calls append(item, playback time) for every item between the first and the last frame, in order of
/// playback time; skips items at the turning point that the previous pass has appended.
template <class Item, class TimeOf, class Append>
void replay(const std::vector<Item>& items, const Pass& pass, TimeOf time_of, Append append) {
  const auto append_in_range = [&](const Item& item) {
    const Timestamp t = time_of(item);
    const bool at_turn = pass.number > 0 && t.ns == (pass.backwards() ? pass.last : pass.first).ns;
    if (t.ns >= pass.first.ns && t.ns <= pass.last.ns && !at_turn) append(item, pass.playback_time(t));
  };
  if (pass.backwards()) {
    std::for_each(items.rbegin(), items.rend(), append_in_range);
  } else {
    for (const Item& item : items) append_in_range(item);
  }
}

std::vector<DetectionSet> replayed_boxes(const std::vector<DetectionSet>& boxes, const Pass& pass) {
  std::vector<DetectionSet> out;
  const auto time_of = [](const DetectionSet& set) { return set.t; };
  replay(boxes, pass, time_of, [&](DetectionSet set, Timestamp t) {
    set.t = t;
    out.push_back(std::move(set));
  });
  return out;
}

class PingPongStream final : public SensorStream {
 public:
  PingPongStream(std::unique_ptr<SensorStream> stream, int passes) : stream_(std::move(stream)) {
    const SequenceInfo& source = stream_->info();
    info_ = {.name = source.name + "_ping_pong",
             .folder = source.folder,
             .format = source.format,
             .id = source.id,
             .rig = source.rig,
             .frame_times = {},
             .imu = {},
             .ground_truth = {{source.ground_truth.trajectory.frame, {}}, source.ground_truth.T_c_f},
             .notes = source.notes,
             .warnings = source.warnings};
    info_.rig.has_imu = false;
    info_.notes.push_back("ping-pong playback: " + std::to_string(passes) +
                          " passes, alternately forwards and backwards, without IMU data");
    for (int number = 0; number < passes; ++number) {
      add_pass({.first = source.frame_times.front(), .last = source.frame_times.back(), .number = number});
    }
  }

  [[nodiscard]] const SequenceInfo& info() const override { return info_; }

  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    Frame frame = stream_->load_frame(frames_[index]);
    frame.id = static_cast<std::int64_t>(index);
    frame.t = info_.frame_times[index];
    return frame;
  }

  [[nodiscard]] bool frames_are_cached() const override { return stream_->frames_are_cached(); }

  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t index) const override {
    return stream_->load_labels(frames_[index]);
  }

 private:
  void add_pass(const Pass& pass) {
    const SequenceInfo& source = stream_->info();
    std::vector<std::size_t> order(source.frame_times.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto time_of_frame = [&](std::size_t i) { return source.frame_times[i]; };
    replay(order, pass, time_of_frame, [&](std::size_t i, Timestamp t) {
      frames_.push_back(i);
      info_.frame_times.push_back(t);
    });
    const auto time_of_pose = [](const StampedPose& pose) { return pose.t; };
    replay(source.ground_truth.trajectory.poses, pass, time_of_pose,
           [&](const StampedPose& pose, Timestamp t) {
             info_.ground_truth.trajectory.poses.push_back({t, pose.T_w_f});
           });
    for (DetectionSet& set : replayed_boxes(source.detections, pass))
      info_.detections.push_back(std::move(set));
    for (DetectionSet& set : replayed_boxes(source.true_boxes, pass))
      info_.true_boxes.push_back(std::move(set));
  }

  std::unique_ptr<SensorStream> stream_;
  SequenceInfo info_;
  std::vector<std::size_t> frames_;  ///< source frame index of each played frame
};

}  // namespace

std::unique_ptr<SensorStream> ping_pong_playback(std::unique_ptr<SensorStream> stream, int passes) {
  if (passes < 1) throw InputError("--passes", "must be 1 or more");
  if (stream->info().frame_times.size() < 2) {
    throw InputError(stream->info().folder.string(),
                     "has fewer than two frames; ping-pong playback needs at least two");
  }
  return std::make_unique<PingPongStream>(std::move(stream), passes);
}

}  // namespace stillpoint::datasets
