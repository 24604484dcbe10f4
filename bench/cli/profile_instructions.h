// SPDX-License-Identifier: BSD-3-Clause
/// `stillpoint profile --instructions`: executed instructions instead of time.
#pragma once

#include <filesystem>
#include <string>

#include "bench/config/config_file.h"

namespace stillpoint {

struct InstructionRequest {
  std::filesystem::path sequence;  ///< folder
  std::string name;                ///< of the sequence
  ConfigRequest config;
  int frames = 0;                ///< from the start
  std::filesystem::path folder;  ///< gets instructions.json, callgrind.out and the files of the run
};

/// Counts and prints. @return exit code
/// @throws InputError if there is no valgrind, or the run fails
int profile_instructions(const InstructionRequest& request);

}  // namespace stillpoint
