// SPDX-License-Identifier: BSD-3-Clause
/// Executes the program `stillpoint`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stillpoint {

struct ProgramResult {
  int exit_code = 0;  ///< 128 + signal number if terminated by a signal
  std::string out;
  std::string err;
};

/// Environment of an execution.
struct ProgramOptions {
  std::vector<std::string> environment;           ///< "NAME=value", added to the environment of the test
  std::optional<std::uint64_t> file_limit_bytes;  ///< maximum file size; simulates a full disk
  std::string out_file;                           ///< receives stdout instead of the result; empty = result
  bool without_write_access = false;              ///< executes as "nobody" if the tests run as root
  std::string interrupt_after;                    ///< send SIGINT once stderr contains this
};

/// @param arguments without the program name
[[nodiscard]] ProgramResult run_program(const std::vector<std::string>& arguments,
                                        const ProgramOptions& options = {});

}  // namespace stillpoint
