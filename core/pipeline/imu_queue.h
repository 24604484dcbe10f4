// SPDX-License-Identifier: BSD-3-Clause
/// IMU samples received ahead of the frames that need them.
#pragma once

#include <limits>
#include <vector>

#include "core/config/odometry_config.h"
#include "core/types/rig.h"

namespace stillpoint {

/// Samples up to this much later than an exposure are added before its frame, because the sample at the
/// exposure is interpolated.
constexpr double kImuLookahead_s = 0.02;

/// Time of the last IMU sample that is used with the frame at `t`.
/// @param time_offset_s estimate when the frame is processed: IMU time of the exposure minus `t`
[[nodiscard]] inline Timestamp imu_end_of(Timestamp t, double time_offset_s) {
  return after(t, time_offset_s + kImuLookahead_s);
}

/// Latest time that `imu_end_of` can return for the frame at `t`.
[[nodiscard]] inline Timestamp last_imu_end_of(Timestamp t, const OdometryConfig& config, const Rig& rig) {
  return imu_end_of(t, rig.time_offset_s + config.backend.time_offset_bound_s);
}

/// Time that the IMU samples must have reached before the frame at `t` is processed; the smallest timestamp
/// if the configuration does not use an IMU.
[[nodiscard]] inline Timestamp needed_imu(Timestamp t, const OdometryConfig& config, double time_offset_s) {
  constexpr Timestamp kNone{std::numeric_limits<std::int64_t>::min()};
  return config.imu.enabled ? imu_end_of(t, time_offset_s) : kNone;
}

/// First in, first out. Makes the samples that a frame is processed with independent of how early they were
/// received, and the results deterministic.
class ImuQueue {
 public:
  void add(const ImuSample& sample) { samples_.push_back(sample); }

  /// Removes the samples up to time `end` and passes them to `sink`.
  template <class Sink>
  void feed_until(Timestamp end, const Sink& sink) {
    auto sample = samples_.begin();
    for (; sample != samples_.end() && sample->t <= end; ++sample) sink(*sample);
    samples_.erase(samples_.begin(), sample);
  }

 private:
  std::vector<ImuSample> samples_;
};

}  // namespace stillpoint
