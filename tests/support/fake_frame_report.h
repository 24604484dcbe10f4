// SPDX-License-Identifier: BSD-3-Clause
/// Frame report of one black frame with configurable features and labels.
#pragma once

#include "core/pipeline/runners/runner.h"

namespace stillpoint {

struct FakeFrameReport {
  Frame frame;
  TrackedFrame tracked;
  DynamicReport dynamic;
  OdometryUpdate update;

  explicit FakeFrameReport(std::int64_t id, cv::Size size = {160, 120}) {
    frame = {.id = id, .gray = cv::Mat::zeros(size, CV_8UC1), .depth = cv::Mat::zeros(size, CV_16UC1)};
    tracked.id = id;
    update.frame_id = id;
  }
  void add_feature(std::int64_t id, double u_px, double v_px) {
    tracked.features.push_back({.id = id, .pixel = {u_px, v_px}});
  }
  [[nodiscard]] FrameReport report() const { return {frame, tracked, dynamic, update}; }
};

}  // namespace stillpoint
