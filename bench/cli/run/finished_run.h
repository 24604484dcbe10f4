// SPDX-License-Identifier: BSD-3-Clause
/// A finished run of a recording, read from its folder or from a store, with what a diagnosis uses of it.
#pragma once

#include <string>
#include <vector>

#include "bench/run/odometry_run.h"
#include "core/config/odometry_config.h"
#include "datasets/faults/sensor_fault.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::bench {

struct FinishedRunSource {
  std::string run;    ///< output folder of `run`, or the key of a stored run or a prefix of it
  std::string store;  ///< file of the store; empty for a folder
};

/// What the run must have been executed with.
struct RunConditions {
  const datasets::SequenceInfo& info;  ///< as it is played
  OdometryConfig config;
  std::vector<datasets::SensorFault> faults;
  std::string rig_file;  ///< empty: the calibration of the sequence
};

/// Reads the poses of the first segment, claims without poses, counters, estimated calibration and noise of
/// the IMU.
/// @throws InputError if a file is missing or malformed, and for a run of another sequence, calibration,
/// config or mode, with other faults, with a map, or not of the first frames of the recording one by one
[[nodiscard]] OdometryRun read_finished_run(const FinishedRunSource& source, const RunConditions& conditions);

}  // namespace stillpoint::bench
