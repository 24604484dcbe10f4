// SPDX-License-Identifier: BSD-3-Clause
/// One black picture of a run and what the odometry said of it, to draw on.
#pragma once

#include "core/pipeline/runner.h"

namespace stillpoint {

struct PictureOfRun {
  Frame frame;
  TrackedFrame tracked;
  DynamicReport dynamic;
  OdometryUpdate update;

  explicit PictureOfRun(std::int64_t id, cv::Size size = {160, 120}) {
    frame = {.id = id, .gray = cv::Mat::zeros(size, CV_8UC1), .depth = cv::Mat::zeros(size, CV_16UC1)};
    tracked.id = id;
    update.frame_id = id;
  }
  void add_feature(std::int64_t id, double u_px, double v_px) {
    tracked.features.push_back({.id = id, .pixel = {u_px, v_px}});
  }
  [[nodiscard]] PictureReport report() const { return {frame, tracked, dynamic, update}; }
};

}  // namespace stillpoint
