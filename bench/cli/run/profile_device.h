// SPDX-License-Identifier: BSD-3-Clause
/// `stillpoint profile --device`: accuracy and latency on a simulated target device.
#pragma once

#include <filesystem>
#include <string>

#include "bench/run/odometry_run.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::bench {

struct DeviceRequest {
  std::string device;  ///< embedded name or TOML file
  RunSpec spec;        ///< `device` is not set
  double budget_ms = 0.0;
  std::filesystem::path folder;  ///< output: device.json and trajectory.tum
};

/// Simulates the device and prints the result. @return exit code
/// @throws InputError if the device does not exist; rethrows errors of the run
int profile_on_device(const datasets::SensorStream& stream, DeviceRequest request);

}  // namespace stillpoint::bench
