// SPDX-License-Identifier: BSD-3-Clause
/// A sequence without files, to be exported.
#pragma once

#include <optional>

#include "datasets/sensor_stream.h"

namespace stillpoint::datasets {

/// Three frames of 8x6 pixels whose intensity encodes their index, an IMU, and ground truth of a marker frame
/// with an offset to the camera.
class SmallStream : public SensorStream {
 public:
  SmallStream() {
    info_.name = "small";
    info_.folder = "small";
    info_.format = "openloris";
    info_.rig.camera = {.width = 8, .height = 6, .fx = 5.0, .fy = 5.5, .cx = 3.5, .cy = 2.5};
    info_.rig.has_imu = true;
    info_.rig.T_b_c = {Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX())), {0.1, 0.2, 0.3}};
    info_.ground_truth.trajectory.frame = "marker";
    info_.ground_truth.T_c_f = {Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.5}};
    for (std::int64_t i = 0; i < 3; ++i) {
      const Timestamp t{1'700'000'000'000'000'000 + i * 33'333'333};
      info_.frame_times.push_back(t);
      info_.ground_truth.trajectory.poses.push_back(
          {t, {Eigen::Quaterniond::Identity(), {static_cast<double>(i), 0.0, 0.0}}});
      info_.imu.push_back({.t = t, .gyro_b = {0.1, 0.2, 1.0 / 3.0}, .accel_b = {0.0, 0.0, 9.81}});
    }
  }
  [[nodiscard]] const SequenceInfo& info() const override { return info_; }
  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    Frame frame;
    frame.id = static_cast<std::int64_t>(index);
    frame.t = info_.frame_times[index];
    frame.gray = cv::Mat(6, 8, CV_8UC1, cv::Scalar(10.0 * static_cast<double>(index)));
    frame.depth = cv::Mat(6, 8, CV_16UC1, cv::Scalar(1000.0));
    return frame;
  }

  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t) const override { return std::nullopt; }

  SequenceInfo info_;
};

}  // namespace stillpoint::datasets
