// SPDX-License-Identifier: BSD-3-Clause
/// A camera and a gyroscope that turn together.
#pragma once

#include <cmath>
#include <vector>

#include "bench/diagnose/evidence/recording_survey.h"
#include "core/geometry/so3.h"

namespace stillpoint::bench {

struct TurningOptions {
  Eigen::Quaterniond q_b_c = Eigen::Quaterniond::Identity();
  double lag_s = 0.0;  ///< of the stamps of the gyroscope
  double seconds = 8.0;
};

/// Rates of 0.5 rad/s about all axes, at periods of 2 to 5 s; 200 samples and 30 frames per second.
struct TurningRig {
  explicit TurningRig(const TurningOptions& options) {
    for (int i = 0; i < static_cast<int>(200 * (options.seconds + 0.6)); ++i) {
      const double t = 0.005 * i - 0.3;
      imu.push_back(
          {.t = from_seconds(10.0 + t + options.lag_s),
           .gyro_b = options.q_b_c * rate_at(t),
           .accel_b = options.q_b_c * Eigen::Vector3d(0.3 * std::sin(5.0 * t),
                                                      -9.81 + 0.2 * std::cos(4.0 * t), 0.1 * std::sin(t))});
    }
    for (int i = 1; i < static_cast<int>(30 * options.seconds); ++i) {
      const double from = (i - 1) / 30.0, to = i / 30.0;
      const Eigen::Vector3d rate = 0.5 * (rate_at(from) + rate_at(to));
      rates.push_back({from_seconds(10.0 + from), from_seconds(10.0 + to), rate});
      survey.frames.push_back({.t = from_seconds(10.0 + to),
                               .mean_gray = 100.0,
                               .deviation_gray = 40.0,
                               .sharpness = 0.5,
                               .depth_ratio = 0.9,
                               .T_now_last = Pose{exp_so3(-rate / 30.0), Eigen::Vector3d::Zero()}});
      info.frame_times.push_back(survey.frames.back().t);
    }
    info.imu = imu;
    info.rig.has_imu = true;
    info.rig.T_b_c.q = options.q_b_c;
  }

  static Eigen::Vector3d rate_at(double t) {
    return 0.5 * Eigen::Vector3d(std::sin(1.3 * t), std::cos(2.1 * t), std::sin(3.1 * t + 0.5));
  }

  std::vector<ImuSample> imu;
  std::vector<datasets::RateInterval> rates;
  RecordingSurvey survey;
  datasets::SequenceInfo info;
};

}  // namespace stillpoint::bench
