// SPDX-License-Identifier: BSD-3-Clause
/// `stillpoint profile --instructions`: instruction counts of callgrind.
#pragma once

#include <filesystem>
#include <string>

#include "bench/config/config_file.h"

namespace stillpoint::bench {

struct InstructionRequest {
  std::filesystem::path sequence;  ///< folder
  std::string name;                ///< name of the sequence
  ConfigRequest config;
  int frames = 0;                ///< number of frames, from the start
  std::filesystem::path folder;  ///< output: instructions.json, callgrind.out and the files of the run
};

/// Counts instructions and prints them. @return exit code
/// @throws InputError if valgrind is not installed or the run fails
int profile_instructions(const InstructionRequest& request);

}  // namespace stillpoint::bench
