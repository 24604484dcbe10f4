// SPDX-License-Identifier: BSD-3-Clause
#include "bench/diagnose/trials.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "eval/metrics/rpe.h"

namespace stillpoint::bench {
namespace {

constexpr std::size_t kLaterFrames = 2;  ///< start of the second run
constexpr double kLost = 10.0;           ///< inconsistency of a frame without a pose
constexpr double kLeastError = 1e-6;     ///< for logarithms
constexpr double kErrorInterval_s = 0.5;
constexpr double kStart_s = 1.0;        ///< time in which the odometry may initialize
constexpr double kSkippedRatio = 0.02;  ///< of frames, that does not count

/// RMS distance of the positions from their mean.
double spread_of(const Trajectory& trajectory) {
  if (trajectory.poses.empty()) return 1.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const StampedPose& pose : trajectory.poses) mean += pose.T_w_f.p;
  mean /= static_cast<double>(trajectory.poses.size());
  double squares = 0.0;
  for (const StampedPose& pose : trajectory.poses) squares += (pose.T_w_f.p - mean).squaredNorm();
  return std::sqrt(squares / static_cast<double>(trajectory.poses.size()));
}

/// Fraction of the frames without a pose, beyond the start and what a few skipped frames are.
double lost_ratio(const RunResult& result) {
  const std::vector<eval::ClaimedPose>& claims = result.run.claims;
  if (claims.empty()) return 1.0;
  const Timestamp begin = after(claims.front().t, kStart_s);
  double frames = 0.0, lost = 0.0;
  for (const eval::ClaimedPose& claim : claims) {
    if (claim.t < begin) continue;
    frames += 1.0;
    lost += claim.claim == eval::PoseClaim::kLocated && claim.segment == 0 ? 0.0 : 1.0;
  }
  return frames > 0.0 ? std::max(0.0, lost / frames - kSkippedRatio) : 0.0;
}

double inconsistency_of(const RunResult& result) {
  double sum = 0.0, count = 0.0;
  for (const Innovations& frame : result.run.innovations) {
    if (!frame.reprojection) continue;
    sum += *frame.reprojection;
    count += 1.0;
  }
  const ImuNoiseFactors& factors = result.run.imu_noise;
  const double located =
      count > 0.0 ? std::sqrt(sum / count) * std::pow(factors.gyro * factors.accel, 0.25) : kLost;
  const double lost = lost_ratio(result);
  return (1.0 - lost) * std::min(located, kLost) + lost * kLost;
}

double error_of(const RunResult& result, ErrorMeasure measure) {
  if (measure == ErrorMeasure::kInconsistency) return std::max(kLeastError, inconsistency_of(result));
  const double spread = spread_of(result.gt);
  if (!result.score.ate) return std::max(kLeastError, spread);
  const double lost = lost_ratio(result);
  return std::max(kLeastError, (1.0 - lost) * result.score.ate->translation_m.rmse + lost * spread);
}

RunResult run_part(const datasets::SensorStream& stream, const TrialRequest& request,
                   const std::vector<Correction>& corrections, std::size_t later) {
  ConfigRequest config = request.config;
  for (const Correction& correction : corrections)
    config.settings.insert(config.settings.end(), correction.settings.begin(), correction.settings.end());
  const auto part =
      corrected_part(stream, {request.part.first + later, request.part.count - later}, corrections);
  const RunSpec spec{.config = load_config(config)};
  return score_run(part->info(), run_odometry(*part, spec, {.stop_requested = request.stop_requested}));
}

/// Errors of a run with the begin and the end of the time that each is of.
struct LocalErrors {
  std::vector<double> errors;
  std::vector<Timestamp> from, to;
};

LocalErrors local_errors(const RunResult& result, ErrorMeasure measure) {
  LocalErrors local;
  if (measure == ErrorMeasure::kTruth) {
    const auto matches = eval::strict_matches(result.gt, result.run.trajectory);
    const auto found = eval::pairs_over_seconds(matches, kErrorInterval_s, 0.1 * kErrorInterval_s);
    local.errors = eval::relative_errors(matches, found.pairs).translation_m;
    for (const eval::PosePair& pair : found.pairs) {
      local.from.push_back(matches[pair.from].t);
      local.to.push_back(matches[pair.to].t);
    }
    return local;
  }
  std::size_t next = 0;
  for (const eval::ClaimedPose& claim : result.run.claims) {
    if (claim.claim != eval::PoseClaim::kLocated || next >= result.run.innovations.size()) continue;
    const Innovations& innovations = result.run.innovations[next++];
    if (!innovations.reprojection) continue;
    local.errors.push_back(std::sqrt(*innovations.reprojection));
    local.from.push_back(claim.t);
    local.to.push_back(claim.t);
  }
  return local;
}

}  // namespace

Trial run_trial(const datasets::SensorStream& stream, const TrialRequest& request,
                const std::vector<Correction>& corrections) {
  struct LaterRun {
    double error = 0.0;
    std::size_t frames = 0;
  };
  auto started = std::async(std::launch::async, [&] {
    const RunResult result = run_part(stream, request, corrections, kLaterFrames);
    return LaterRun{error_of(result, request.measure), result.run.summary.frames};
  });
  Trial trial{.result = run_part(stream, request, corrections, 0)};
  const LaterRun later = started.get();
  trial.frames = std::min(trial.result.run.summary.frames, later.frames + kLaterFrames);
  const double first = std::log(error_of(trial.result, request.measure)), second = std::log(later.error);
  trial.error = std::exp(0.5 * (first + second));
  trial.difference = first - second;
  return trial;
}

Trial trial_of(const datasets::SensorStream& stream, const TrialRequest& request, OdometryRun run) {
  const auto part = corrected_part(stream, request.part, {});
  const Timestamp last = part->info().frame_times.back();
  std::erase_if(run.claims, [&](const eval::ClaimedPose& claim) { return claim.t > last; });
  std::erase_if(run.trajectory.poses, [&](const StampedPose& pose) { return pose.t > last; });
  std::erase_if(run.frame_counters, [&](const FrameCounters& frame) { return Timestamp{frame.t_ns} > last; });
  run.summary.frames = std::min(run.summary.frames, request.part.count);
  Trial trial{.frames = run.summary.frames, .result = score_run(part->info(), std::move(run))};
  trial.error = error_of(trial.result, request.measure);
  return trial;
}

Trajectory visual_trajectory(const datasets::SensorStream& stream, const TrialRequest& request,
                             const std::vector<Correction>& corrections) {
  TrialRequest visual = request;
  visual.config.variant = "vo";
  try {
    return run_part(stream, visual, corrections, 0).run.trajectory;
  } catch (const InputError&) {
    return {};  // the trial without this change has reported it, or has an IMU only
  }
}

std::optional<double> error_ratio_outside(const RunResult& result, ErrorMeasure measure,
                                          std::span<const Timestamp> times) {
  const LocalErrors local = local_errors(result, measure);
  double all = 0.0, outside = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < local.errors.size(); ++i) {
    const double square = local.errors[i] * local.errors[i];
    all += square;
    const auto next = std::ranges::lower_bound(times, after(local.from[i], -kErrorInterval_s));
    if (next != times.end() && *next <= local.to[i]) continue;
    outside += square;
    ++count;
  }
  if (10 * count <= local.errors.size() || all <= 0.0) return std::nullopt;
  return std::sqrt(outside / static_cast<double>(count) / (all / static_cast<double>(local.errors.size())));
}

}  // namespace stillpoint::bench
