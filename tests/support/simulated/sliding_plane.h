// SPDX-License-Identifier: BSD-3-Clause
/// A camera translating parallel to a textured plane: exact images without a renderer.
#pragma once

#include <vector>

#include "core/pipeline/runners/runner.h"
#include "tests/support/random.h"

namespace stillpoint {

/// Images of 160x120 px at 30 Hz; in each, the plane at 2 m is `kStep_px` further left than in the previous.
class SlidingPlane {
 public:
  static constexpr double kDepth_m = 2.0;
  static constexpr double kFocal_px = 150.0;
  static constexpr int kStep_px = 2;

  explicit SlidingPlane(int frame_count) : texture_(kHeight, kWidth + kStep_px * frame_count, CV_8UC1) {
    Random random(3);
    for (int row = 0; row < texture_.rows; row += kBlock_px) {
      for (int column = 0; column < texture_.cols; column += kBlock_px) {
        const cv::Rect block(column, row, kBlock_px, kBlock_px);
        texture_(block & cv::Rect(0, 0, texture_.cols, texture_.rows)) = random.uniform(20.0, 235.0);
      }
    }
    for (int i = 0; i < frame_count; ++i) times_.push_back(Timestamp{1'000'000'000 + i * 33'333'333LL});
  }

  /// Position of the camera along its x axis at a frame [m].
  static double camera_x_m(std::int64_t frame) {
    return static_cast<double>(frame) * kStep_px * kDepth_m / kFocal_px;
  }

  [[nodiscard]] Frame frame(std::size_t index) const {
    Frame frame{.id = static_cast<std::int64_t>(index), .t = times_[index]};
    frame.gray = texture_(cv::Rect(kStep_px * static_cast<int>(index), 0, kWidth, kHeight)).clone();
    frame.depth = cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(1000.0 * kDepth_m));
    return frame;
  }

  /// References this object, which must outlive the input.
  [[nodiscard]] SensorInput input() const {
    SensorInput input;
    input.rig.camera = {.width = kWidth,
                        .height = kHeight,
                        .fx = kFocal_px,
                        .fy = kFocal_px,
                        .cx = 0.5 * (kWidth - 1),
                        .cy = 0.5 * (kHeight - 1)};
    input.frame_times = times_;
    input.load_frame = [this](std::size_t index) { return frame(index); };
    return input;
  }

 private:
  static constexpr int kWidth = 160;
  static constexpr int kHeight = 120;
  static constexpr int kBlock_px = 8;

  cv::Mat texture_;
  std::vector<Timestamp> times_;
};

}  // namespace stillpoint
