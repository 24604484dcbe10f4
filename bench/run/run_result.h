// SPDX-License-Identifier: BSD-3-Clause
/// The scored result of one run, the content of its result.json.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/model/metrics.h"
#include "bench/run/odometry_run.h"
#include "datasets/faults/sensor_fault.h"
#include "eval/compare/conventions.h"

namespace stillpoint::bench {

struct RunResult {
  std::string sequence;
  std::string variant;
  std::string mode;
  Outcome outcome = Outcome::kOk;     ///< or kLost or kInterrupted
  std::string failure;                ///< reason when not ok
  std::vector<std::string> notes;     ///< assumptions of the sequence reader
  std::vector<std::string> warnings;  ///< irregularities of the data, as "LOCATION: FAULT"
  Trajectory gt;                      ///< of the camera, over the processed frames
  /// What explains errors against the ground truth, such as another unit or body frame.
  std::vector<eval::ConventionFinding> conventions;
  eval::Score score;
  std::optional<eval::Honesty> honesty;  ///< if faults were injected
  std::optional<LoopScore> loops;        ///< if loop closure was on
  std::optional<ImuRateScore> imu_rate;  ///< if poses at IMU rate were recorded
  OdometryRun run;
  double start_s = 0.0;  ///< from the start of the process to that of the run: loading, config, opening
};

/// What the metrics of the run are computed from; refers to `result`.
[[nodiscard]] Measurements measurements_of(const RunResult& result);

/// The warnings of a run that make its errors doubtful: about its trajectory, the ground truth and injected
/// faults; separated by semicolons, empty without any.
[[nodiscard]] std::string error_doubt(std::span<const std::string> warnings);

/// Scores a run against the sequence's ground truth, transformed to the camera frame. An interrupted run is
/// scored on its processed frames.
/// @param faults that were injected
[[nodiscard]] RunResult score_run(const datasets::SequenceInfo& info, OdometryRun run,
                                  std::span<const datasets::SensorFault> faults = {});

}  // namespace stillpoint::bench
