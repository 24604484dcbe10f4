// SPDX-License-Identifier: BSD-3-Clause
// Example: feeds the odometry by hand and prints its poses. The sensors are simulated: a camera moves at
// 0.8 m/s to the right in front of a textured wall; gravity points down in the image.
#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <cstdio>

#include "core/pipeline/odometry.h"

namespace {

constexpr double kFrameInterval_s = 0.025, kImuInterval_s = 0.005, kDistance_m = 2.0, kFocal_px = 200.0;
constexpr int kShift_px = 2;  // per frame: 0.02 m

stillpoint::Rig make_rig() {
  stillpoint::Rig rig;
  rig.camera = {.width = 320, .height = 240, .fx = kFocal_px, .fy = kFocal_px, .cx = 159.5, .cy = 119.5};
  rig.has_imu = true;  // rig.T_b_c is the identity: camera and IMU coincide
  return rig;
}

stillpoint::Frame take_frame(int index) {
  stillpoint::Frame frame{.id = index, .t = stillpoint::from_seconds(1.0 + kFrameInterval_s * index)};
  frame.gray = cv::Mat(240, 320, CV_8UC1);
  frame.depth = cv::Mat(240, 320, CV_16UC1, cv::Scalar(kDistance_m * frame.depth_units_per_m));
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {  // blocks of 8 px with a pseudo-random brightness
      const auto block = static_cast<std::uint32_t>((v / 8) * 7919 + (u + kShift_px * index) / 8);
      frame.gray.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>((block * 2654435761u) >> 24);
    }
  }
  return frame;
}

}  // namespace

int main() {
  stillpoint::Odometry odometry(stillpoint::OdometryConfig{}, make_rig());  // the default of `stillpoint run`
  stillpoint::Timestamp imu_time = stillpoint::from_seconds(0.9);
  for (int i = 0; i < 60; ++i) {
    const stillpoint::Frame frame = take_frame(i);
    for (; imu_time <= odometry.needs_imu_until(frame.t); imu_time = after(imu_time, kImuInterval_s)) {
      odometry.add_imu({.t = imu_time, .accel_b = {0.0, -9.81, 0.0}});
    }
    const stillpoint::OdometryUpdate& update =
        odometry.track(frame);  // your detector's boxes are the second argument
    const Eigen::Vector3d& p = update.T_w_c.p;
    if (!stillpoint::is_located(update.status)) continue;
    std::printf("t %.3f s  position (%+.3f, %+.3f, %+.3f) m\n", to_seconds(frame.t), p.x(), p.y(), p.z());
  }
  return odometry.state().has_value() ? 0 : 1;
}
