// SPDX-License-Identifier: BSD-3-Clause
/// Runs of the odometry on a part of a recording, with corrections, and their errors.
///
/// The error of a run is that of its positions, where frames without a pose count with the spread of the
/// truth S (the error of an estimate that never moves):
///   e = (1 - l) ATE + l S,   l: fraction of the frames after 1 s without a pose, minus 2 % (at least 0),
///                            S: RMS distance from the mean.
/// Without ground truth, the inconsistency of the run takes its place:
///   e = (1 - l) q + 10 l,   q = sqrt(NIS of reprojection) (f_gyro f_accel)^(1/4),
/// with the mean normalized innovation squared, and the factors f by which the errors of the IMU exceed its
/// stated noise.
///
/// Each trial consists of two runs, of which one starts two frames later: their difference tells by how much
/// the error changes without a reason.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/config/config_file.h"
#include "bench/diagnose/correction.h"
#include "bench/run/odometry_run.h"
#include "bench/run/run_result.h"

namespace stillpoint::bench {

enum class ErrorMeasure { kTruth, kInconsistency };

struct TrialRequest {
  ConfigRequest config;
  RecordingPart part;
  ErrorMeasure measure = ErrorMeasure::kTruth;
  std::function<bool()> stop_requested{};
};

struct Trial {
  double error = 0.0;       ///< geometric mean of both runs [m], or without unit
  double difference = 0.0;  ///< of the logarithms of their errors
  std::size_t frames = 0;   ///< of the part that both runs processed; fewer than it has if they were stopped
  RunResult result;         ///< of the run from the first frame of the part
};

/// Executes the two runs of a trial at the same time.
/// @throws InputError of the first run, e.g. for a config that the data does not suffice for
[[nodiscard]] Trial run_trial(const datasets::SensorStream& stream, const TrialRequest& request,
                              const std::vector<Correction>& corrections);

/// A finished run of the first frames of the recording as a trial, cut to the part: without a second run.
/// @param run may lack innovations and the poses of its claims if the measure is `kTruth`
[[nodiscard]] Trial trial_of(const datasets::SensorStream& stream, const TrialRequest& request,
                             OdometryRun run);

/// Trajectory of the camera by a run without IMU; empty if it fails.
[[nodiscard]] Trajectory visual_trajectory(const datasets::SensorStream& stream, const TrialRequest& request,
                                           const std::vector<Correction>& corrections);

/// Ratio of the root mean square of the errors outside of the times (by more than 0.5 s) to that of all: with
/// ground truth of the motion over 0.5 s, else of the innovations.
/// @return nullopt if a tenth of the errors or less is outside
[[nodiscard]] std::optional<double> error_ratio_outside(const RunResult& result, ErrorMeasure measure,
                                                        std::span<const Timestamp> times);

}  // namespace stillpoint::bench
