// SPDX-License-Identifier: BSD-3-Clause
#include "bench/diagnose/correction.h"

#include <algorithm>
#include <utility>

#include <opencv2/core.hpp>

namespace stillpoint::bench {
namespace {

cv::Mat mirrored_image(const cv::Mat& image) {
  cv::Mat result;
  if (!image.empty()) cv::flip(image, result, 1);
  return result;
}

/// Pixel p of the result is pixel p + shift; 0 where that is outside.
cv::Mat shifted_depth(const cv::Mat& depth, const Eigen::Vector2i& shift_px) {
  if (depth.empty()) return {};
  cv::Mat result = cv::Mat::zeros(depth.size(), depth.type());
  const cv::Rect image(0, 0, depth.cols, depth.rows),
      moved(shift_px.x(), shift_px.y(), depth.cols, depth.rows);
  const cv::Rect source = image & moved;
  if (!source.empty()) depth(source).copyTo(result(cv::Rect(source.tl() - moved.tl(), source.size())));
  return result;
}

void mirror(datasets::SequenceInfo& info) {
  const double last_px = info.rig.camera.width - 1.0;
  info.rig.camera.cx = last_px - info.rig.camera.cx;
  for (auto* const sets : {&info.detections, &info.true_boxes}) {
    for (DetectionSet& set : *sets) {
      for (Detection& detection : set.detections) {
        detection.box.x_min = last_px - detection.box.x_min;
        detection.box.x_max = last_px - detection.box.x_max;
        std::swap(detection.box.x_min, detection.box.x_max);
      }
    }
  }
}

class CorrectedPart final : public datasets::SensorStream {
 public:
  CorrectedPart(const datasets::SensorStream& stream, const RecordingPart& part,
                const std::vector<Correction>& corrections)
      : stream_(stream), first_(part.first), info_(stream.info()) {
    const auto begin = info_.frame_times.begin() + static_cast<std::ptrdiff_t>(part.first);
    info_.frame_times = {begin, begin + static_cast<std::ptrdiff_t>(part.count)};
    const Timestamp start = info_.frame_times.front();
    if (part.first > 0) std::erase_if(info_.imu, [&](const ImuSample& sample) { return sample.t < start; });
    for (const Correction& correction : corrections) {
      if (correction.change) correction.change(info_);
      depth_factor_ *= correction.depth_factor;
      depth_delay_ += correction.depth_delay;
      depth_shift_px_ += correction.depth_shift_px;
      if (correction.mirrored) {
        mirrored_ = !mirrored_;
        mirror(info_);
      }
    }
    info_.rig.depth_units_per_m /= depth_factor_;
  }

  [[nodiscard]] const datasets::SequenceInfo& info() const override { return info_; }

  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    Frame frame = stream_.load_frame(first_ + index);
    if (depth_delay_ != 0) frame.depth = stream_.load_frame(depth_index(first_ + index)).depth;
    if (!depth_shift_px_.isZero()) frame.depth = shifted_depth(frame.depth, depth_shift_px_);
    frame.id = static_cast<std::int64_t>(index);
    frame.t = info_.frame_times.at(index);
    frame.depth_units_per_m /= depth_factor_;
    if (mirrored_) {
      frame.gray = mirrored_image(frame.gray);
      frame.depth = mirrored_image(frame.depth);
      frame.color = mirrored_image(frame.color);
      if (frame.decode_color)
        frame.decode_color = [decode = frame.decode_color] { return mirrored_image(decode()); };
    }
    return frame;
  }

  [[nodiscard]] bool frames_are_cached() const override { return stream_.frames_are_cached(); }

  [[nodiscard]] std::optional<datasets::MotionLabels> load_labels(std::size_t) const override { return {}; }

 private:
  /// The frame with which the depth of another one was recorded; clamped to the recording.
  [[nodiscard]] std::size_t depth_index(std::size_t index) const {
    const auto last = static_cast<std::ptrdiff_t>(stream_.info().frame_times.size()) - 1;
    return static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(index) + depth_delay_, 0, last));
  }

  const datasets::SensorStream& stream_;
  std::size_t first_;
  datasets::SequenceInfo info_;
  double depth_factor_ = 1.0;
  int depth_delay_ = 0;
  Eigen::Vector2i depth_shift_px_ = Eigen::Vector2i::Zero();
  bool mirrored_ = false;
};

}  // namespace

std::unique_ptr<datasets::SensorStream> corrected_part(const datasets::SensorStream& stream,
                                                       const RecordingPart& part,
                                                       const std::vector<Correction>& corrections) {
  return std::make_unique<CorrectedPart>(stream, part, corrections);
}

}  // namespace stillpoint::bench
