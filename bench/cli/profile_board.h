// SPDX-License-Identifier: BSD-3-Clause
/// `stillpoint profile --board`: accuracy and speed that another machine would have.
#pragma once

#include <filesystem>
#include <string>

#include "bench/run/odometry_run.h"
#include "datasets/sensor_stream.h"

namespace stillpoint {

struct BoardRequest {
  std::string board;  ///< embedded name or file
  RunSpec spec;       ///< without board
  double budget_ms = 0.0;
  std::filesystem::path folder;  ///< gets board.json and trajectory.tum
};

/// Runs and prints. @return exit code
/// @throws InputError if there is no such board, and what the run throws
int profile_on_board(const SensorStream& stream, BoardRequest request);

}  // namespace stillpoint
