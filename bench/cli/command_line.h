// SPDX-License-Identifier: BSD-3-Clause
/// Parses the command line and executes the selected command.
#pragma once

#include <vector>

#include "bench/cli/command.h"

namespace stillpoint::bench {

/// Exit codes of the program.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFindings = 1;       ///< completed, but the result is negative, e.g. a failed run
inline constexpr int kExitBadInput = 2;       ///< invalid usage or input; one error line was printed
inline constexpr int kExitInternal = 3;       ///< a bug in the program, or out of memory
inline constexpr int kExitInterrupted = 130;  ///< 128 + SIGINT, as shells report it

/// @return exit code of the command; `kExitBadInput`, with one line on stderr, for invalid usage or
/// InputError
[[nodiscard]] int run_command_line(int argc, char** argv, const std::vector<Command>& commands);

}  // namespace stillpoint::bench
