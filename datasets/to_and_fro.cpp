// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/to_and_fro.h"

#include <numeric>
#include <ranges>
#include <utility>

#include "core/base/error.h"

namespace stillpoint {
namespace {

/// The time of one pass, laid end to end with the others.
struct Pass {
  Timestamp first;  ///< of the sequence
  Timestamp last;
  int number = 0;

  [[nodiscard]] bool backwards() const { return number % 2 == 1; }
  [[nodiscard]] Timestamp placed(Timestamp t) const {
    const std::int64_t into = backwards() ? last.ns - t.ns : t.ns - first.ns;
    return {.ns = first.ns + number * (last.ns - first.ns) + into};
  }
};

/// Calls use(item, its new time) for what lies within the pictures, in order of the new times; what lies at a
/// turn once.
template <class Item, class TimeOf, class Use>
void replay(const std::vector<Item>& items, const Pass& pass, TimeOf time_of, Use use) {
  const auto offer = [&](const Item& item) {
    const Timestamp t = time_of(item);
    const bool at_turn = pass.number > 0 && t.ns == (pass.backwards() ? pass.last : pass.first).ns;
    if (t.ns >= pass.first.ns && t.ns <= pass.last.ns && !at_turn) use(item, pass.placed(t));
  };
  if (pass.backwards()) {
    for (const Item& item : std::views::reverse(items)) offer(item);
  } else {
    for (const Item& item : items) offer(item);
  }
}

void replay_boxes(const std::vector<DetectionSet>& boxes, const Pass& pass, std::vector<DetectionSet>& to) {
  const auto time_of = [](const DetectionSet& set) { return set.t; };
  replay(boxes, pass, time_of, [&](DetectionSet set, Timestamp t) {
    set.t = t;
    to.push_back(std::move(set));
  });
}

class ToAndFro final : public SensorStream {
 public:
  ToAndFro(std::unique_ptr<SensorStream> stream, int passes) : stream_(std::move(stream)) {
    const SequenceInfo& once = stream_->info();
    info_ = {.name = once.name + "_to_and_fro",
             .folder = once.folder,
             .format = once.format,
             .rig = once.rig,
             .frame_times = {},
             .imu = {},
             .ground_truth = {{once.ground_truth.trajectory.frame, {}}, once.ground_truth.T_c_f},
             .notes = once.notes};
    info_.rig.has_imu = false;
    info_.notes.push_back("played forwards and backwards in turn, " + std::to_string(passes) +
                          " times, without inertial data");
    for (int number = 0; number < passes; ++number) {
      add_pass({.first = once.frame_times.front(), .last = once.frame_times.back(), .number = number});
    }
  }

  [[nodiscard]] const SequenceInfo& info() const override { return info_; }

  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    Frame frame = stream_->load_frame(frames_[index]);
    frame.id = static_cast<std::int64_t>(index);
    frame.t = info_.frame_times[index];
    return frame;
  }

  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t index) const override {
    return stream_->load_labels(frames_[index]);
  }

 private:
  void add_pass(const Pass& pass) {
    const SequenceInfo& once = stream_->info();
    std::vector<std::size_t> order(once.frame_times.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto time_of_frame = [&](std::size_t i) { return once.frame_times[i]; };
    replay(order, pass, time_of_frame, [&](std::size_t i, Timestamp t) {
      frames_.push_back(i);
      info_.frame_times.push_back(t);
    });
    const auto time_of_pose = [](const StampedPose& pose) { return pose.t; };
    replay(once.ground_truth.trajectory.poses, pass, time_of_pose, [&](const StampedPose& pose, Timestamp t) {
      info_.ground_truth.trajectory.poses.push_back({t, pose.T_w_f});
    });
    replay_boxes(once.detections, pass, info_.detections);
    replay_boxes(once.true_boxes, pass, info_.true_boxes);
  }

  std::unique_ptr<SensorStream> stream_;
  SequenceInfo info_;
  std::vector<std::size_t> frames_;  ///< of the sequence, for each that is shown
};

}  // namespace

std::unique_ptr<SensorStream> play_to_and_fro(std::unique_ptr<SensorStream> stream, int passes) {
  if (passes < 1) throw InputError("--passes", "must be 1 or more");
  if (stream->info().frame_times.size() < 2) {
    throw InputError(stream->info().folder.string(), "has too few pictures to be played backwards");
  }
  return std::make_unique<ToAndFro>(std::move(stream), passes);
}

}  // namespace stillpoint
