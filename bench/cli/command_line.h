// SPDX-License-Identifier: BSD-3-Clause
/// Parses the program's arguments and runs the chosen command.
#pragma once

#include <vector>

#include "bench/cli/command.h"

namespace stillpoint {

/// Exit codes of the program.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFindings = 1;       ///< the work was done, and its result is not good
inline constexpr int kExitBadInput = 2;       ///< one error line was printed
inline constexpr int kExitInternal = 3;       ///< a bug of ours, or a machine out of memory
inline constexpr int kExitInterrupted = 130;  ///< as shells report a program ended by Ctrl-C

/// @return the command's exit code; `kExitBadInput` with one line on stderr for wrong usage or an InputError
[[nodiscard]] int run_command_line(int argc, char** argv, const std::vector<Command>& commands);

}  // namespace stillpoint
