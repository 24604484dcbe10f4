// SPDX-License-Identifier: BSD-3-Clause
/// Runs the estimator on simulated motion with faults of features and inertial samples, for tests of its
/// reactions to failures.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "core/backend/estimator.h"
#include "tests/support/published_config.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {

inline constexpr double kBegin_s = 4.0;  ///< of faults
inline constexpr double kEnd_s = 100.0;  ///< after the runs

/// The published backend with the settings of the default that matter to the scenarios, besides the prior:
/// their limits were set with it.
inline BackendConfig default_backend() {
  BackendConfig config = published_config().backend;
  config.rate_hz = 0.0;
  config.solver = WindowSolverKind::kSchur;
  config.gravity = GravityModel::kEstimated;
  config.max_iterations = 4;
  config.keyframe_max_interval_s = 0.5;
  config.depth.usage = DepthUsage::kWeighted;
  config.initializer.kind = InitializerKind::kInstant;
  config.covariance = true;
  return config;
}

/// The prior of the default with the noise of the scenarios.
inline void use_consistent_prior(BackendConfig& config) {
  config.prior = PriorModel::kConsistent;
  config.pixel_sigma_px = 0.5;
  config.time_offset_model = TimeOffsetModel::kInertial;
  config.time_offset_walk = 0.001;
}

struct FaultyScenario {
  SimulatedMotion motion{.pixel_noise_px = 0.5, .depth_noise = 0.003, .noisy_imu = true};
  BackendConfig backend = default_backend();
  bool uses_imu = true;
  double seconds = 10.0;
  double imu_rate_hz = 200.0;
  std::function<void(TrackedFrame&)> change_frame;
  std::function<void(std::vector<ImuSample>&)> change_imu;
};

struct FaultyFrame {
  double t = 0.0;
  OdometryUpdate update;
  double error_m = 0.0;  ///< of the motion since the first located frame
};

inline bool is_finite(const FaultyFrame& frame) {
  return frame.update.state.T_w_b.p.allFinite() && frame.update.state.T_w_b.q.coeffs().allFinite();
}

struct FaultyRun {
  std::vector<FaultyFrame> frames;

  /// Frames with the given property in [begin, end).
  template <class Predicate>
  [[nodiscard]] int count(double begin, double end, const Predicate& predicate) const {
    return static_cast<int>(std::ranges::count_if(frames, [&](const FaultyFrame& frame) {
      return frame.t >= begin && frame.t < end && predicate(frame);
    }));
  }
  [[nodiscard]] int count(double begin, double end, OdometryStatus status) const {
    return count(begin, end, [&](const FaultyFrame& frame) { return frame.update.status == status; });
  }
  [[nodiscard]] int count_located(double begin, double end) const {
    return count(begin, end, [](const FaultyFrame& frame) { return is_located(frame.update.status); });
  }
  /// Largest error of the located frames in [begin, end) [m].
  [[nodiscard]] double worst_error_m(double begin, double end) const {
    double worst = 0.0;
    for (const FaultyFrame& frame : frames) {
      if (frame.t >= begin && frame.t < end && is_located(frame.update.status))
        worst = std::max(worst, frame.error_m);
    }
    return worst;
  }
};

/// The sensors of a scenario.
inline Rig rig_of(const FaultyScenario& scenario) {
  Rig rig = SimulatedMotion::rig();
  rig.imu_noise = scenario.motion.imu_noise;
  return rig;
}

inline ImuConfig imu_config_of(const FaultyScenario& scenario) {
  ImuConfig config = published_config().imu;
  config.enabled = scenario.uses_imu;
  return config;
}

/// Frames at 30 Hz from 0.1 s on; the samples of a frame end 20 ms after it, as in the runners.
/// @param odometry has `add_imu`
/// @param process  from a frame to its OdometryUpdate, by that odometry
template <class Odometry, class Process>
FaultyRun run_with_faults(const FaultyScenario& scenario, Odometry& odometry, const Process& process) {
  std::vector<ImuSample> imu = scenario.motion.imu(scenario.seconds + 0.5, scenario.imu_rate_hz);
  if (scenario.change_imu) scenario.change_imu(imu);
  std::size_t next = 0;
  std::optional<Pose> T_first, T_first_true;
  FaultyRun run;
  for (int i = 0; i < static_cast<int>(30.0 * scenario.seconds); ++i) {
    const double t = 0.1 + i / 30.0;
    for (; next < imu.size() && to_seconds(imu[next].t) < t + 0.02; ++next) odometry.add_imu(imu[next]);
    TrackedFrame frame = scenario.motion.frame(i, t);
    if (scenario.change_frame) scenario.change_frame(frame);
    const OdometryUpdate& update = process(frame);
    const Pose truth = SimulatedMotion::state(t + scenario.motion.time_offset_s).T_w_b;
    if (!T_first && is_located(update.status)) {
      T_first = update.state.T_w_b;
      T_first_true = truth;
    }
    double error_m = 0.0;
    if (T_first) {
      error_m = ((T_first->inverse() * update.state.T_w_b).p - (T_first_true->inverse() * truth).p).norm();
    }
    run.frames.push_back({.t = t, .update = update, .error_m = error_m});
  }
  return run;
}

/// Same by the estimator alone.
inline FaultyRun run_with_faults(const FaultyScenario& scenario) {
  Estimator estimator(scenario.backend, imu_config_of(scenario), rig_of(scenario), 1);
  return run_with_faults(scenario, estimator, [&](const TrackedFrame& frame) -> const OdometryUpdate& {
    return estimator.process(frame);
  });
}

/// No features in [begin, end) s. Afterwards the tracks have new ids, unless they are recognized again.
inline std::function<void(TrackedFrame&)> blank(double begin, double end, bool recognized) {
  return [=](TrackedFrame& frame) {
    const double t = to_seconds(frame.t);
    if (t >= begin && t < end) frame.features.clear();
    if (t < end || recognized) return;
    for (TrackedFeature& feature : frame.features) feature.id += 100000;
  };
}

/// No samples in [begin, end) s.
inline std::function<void(std::vector<ImuSample>&)> imu_gap(double begin, double end) {
  return [=](std::vector<ImuSample>& samples) {
    std::erase_if(samples, [&](const ImuSample& sample) {
      return to_seconds(sample.t) >= begin && to_seconds(sample.t) < end;
    });
  };
}

/// Adds a specific force [m/s^2] in [begin, end) s.
inline std::function<void(std::vector<ImuSample>&)> shock(double begin, double end,
                                                          const Eigen::Vector3d& force_b) {
  return [=](std::vector<ImuSample>& samples) {
    for (ImuSample& sample : samples) {
      if (to_seconds(sample.t) >= begin && to_seconds(sample.t) < end) sample.accel_b += force_b;
    }
  };
}

}  // namespace stillpoint
