// SPDX-License-Identifier: BSD-3-Clause
/// Runs the program itself as a child, so that a crash or a runaway run costs one row and not the table.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace stillpoint {

struct ChildResult {
  int exit_code = 0;         ///< 128 + the signal's number when a signal ended it, as shells count
  std::string last_message;  ///< last line that the child wrote to stderr
};

/// @param arguments     without the program's name
/// @param stop_requested asked whenever a signal comes in; when true the child is asked to end too; may be
/// empty
/// @throws std::system_error if no process can be made
[[nodiscard]] ChildResult run_self(const std::vector<std::string>& arguments,
                                   const std::function<bool()>& stop_requested);

}  // namespace stillpoint
