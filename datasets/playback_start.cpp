// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/playback_start.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

class LateStream final : public SensorStream {
 public:
  /// @param first index of the first frame that is played
  LateStream(std::unique_ptr<SensorStream> stream, Timestamp start, std::size_t first)
      : stream_(std::move(stream)), info_(stream_->info()), first_(first) {
    const auto is_early = [&](const auto& item) { return item.t < start; };
    info_.frame_times.erase(info_.frame_times.begin(),
                            info_.frame_times.begin() + static_cast<std::ptrdiff_t>(first));
    std::erase_if(info_.imu, is_early);
    std::erase_if(info_.ground_truth.trajectory.poses, is_early);
    std::erase_if(info_.detections, is_early);
    std::erase_if(info_.true_boxes, is_early);
  }

  [[nodiscard]] const SequenceInfo& info() const override { return info_; }
  void note(std::string text) { info_.notes.push_back(std::move(text)); }

  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    Frame frame = stream_->load_frame(first_ + index);
    frame.id = static_cast<std::int64_t>(index);
    return frame;
  }

  [[nodiscard]] bool frames_are_cached() const override { return stream_->frames_are_cached(); }

  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t index) const override {
    return stream_->load_labels(first_ + index);
  }

 private:
  std::unique_ptr<SensorStream> stream_;
  SequenceInfo info_;
  std::size_t first_;
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
  auto late = std::make_unique<LateStream>(std::move(stream), start, skipped);
  late->note(fmt::format("begins {:g} s after the first frame of the sequence, without its {} first frames",
                         start_s, skipped));
  return late;
}

}  // namespace stillpoint::datasets
