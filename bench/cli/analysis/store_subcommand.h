// SPDX-License-Identifier: BSD-3-Clause
/// Common part of the subcommands of `store`.
#pragma once

#include <memory>

#include "bench/cli/command_line.h"

namespace stillpoint::bench {

/// Adds the option `--store` and the action to a command.
/// @param arguments target of the options; must have a member `store`
template <class Arguments>
[[nodiscard]] Command store_subcommand(Command command, const std::shared_ptr<Arguments>& arguments,
                                       int (*action)(const Arguments&)) {
  command.options.push_back({"--store", "Database of runs [build/bench/store.sqlite]", &arguments->store});
  command.action = [arguments, action] { return action(*arguments); };
  return command;
}

}  // namespace stillpoint::bench
