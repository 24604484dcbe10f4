// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/standstill.h"

#include "core/imu/zero_velocity.h"

namespace stillpoint {
namespace {

constexpr double kInterval_s = 0.2;
constexpr double kMaxSpeed = 0.1;  // [m/s]
constexpr int kMinFeatures = 10;

/// The newest frame that is at least `kInterval_s` older than the newest one; -1 if there is none.
int earlier_frame(const Window& window) {
  int frame = window.newest() - 1;
  const Timestamp newest = window.frames.back().state.t;
  while (frame >= 0 &&
         seconds_between(window.frames[static_cast<std::size_t>(frame)].state.t, newest) < kInterval_s)
    --frame;
  return frame;
}

bool features_rest(const Window& window, const ZeroVelocityConfig& config, double focal_px) {
  const int earlier = earlier_frame(window);
  if (earlier < 0) return false;
  int common = 0;
  int resting = 0;
  for (const Landmark& landmark : window.landmarks) {
    if (!landmark.observed_in(earlier) || !landmark.observed_in(window.newest())) continue;
    ++common;
    const Eigen::Vector2d motion =
        landmark.observation_in(window.newest()).bearing - landmark.observation_in(earlier).bearing;
    resting += focal_px * motion.norm() <= config.static_px;
  }
  return resting >= kMinFeatures && resting >= config.min_static_ratio * common;
}

}  // namespace

bool is_at_rest(const Window& window, ImuBuffer& imu, const ZeroVelocityConfig& config,
                const StandstillModel& model) {
  const NavState& state = window.frames.back().state;
  if (!window.inertial || state.v_w.norm() > kMaxSpeed) return false;
  const Timestamp end = after(state.t, window.time_offset_s);
  const std::vector<ImuSample>& samples = imu.samples_up_to(after(end, -kInterval_s), end);
  return zero_velocity_statistic(samples, state, model.noise, model.gravity) <= config.statistic &&
         features_rest(window, config, model.focal_px);
}

}  // namespace stillpoint
