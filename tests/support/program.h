// SPDX-License-Identifier: BSD-3-Clause
/// Runs the program `stillpoint` as its users do.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stillpoint {

struct ProgramResult {
  int exit_code = 0;  ///< 128 + the signal's number when a signal ended it
  std::string out;
  std::string err;
};

/// Circumstances of a run; what is empty is as usual.
struct ProgramOptions {
  std::vector<std::string> environment;           ///< "NAME=value", besides the test's own
  std::optional<std::uint64_t> file_limit_bytes;  ///< no file grows beyond it, as on a full disk
  bool may_only_read = false;                     ///< runs as "nobody" where the tests run as root
  std::string interrupt_after;                    ///< SIGINT is sent once when stderr contains this
};

/// @param arguments without the program's name
[[nodiscard]] ProgramResult run_program(const std::vector<std::string>& arguments,
                                        const ProgramOptions& options = {});

}  // namespace stillpoint
