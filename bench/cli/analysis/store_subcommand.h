// SPDX-License-Identifier: BSD-3-Clause
/// Common part of the subcommands of `store`.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/cli/command.h"

namespace stillpoint::bench {

/// @param example   without `store`
/// @param options   without `--store`, which is added
/// @param arguments target of the options; must have a member `store`
template <class Arguments>
[[nodiscard]] Command store_subcommand(const std::string& name, const std::string& summary,
                                       const std::string& example, std::vector<Option> options,
                                       const std::shared_ptr<Arguments>& arguments,
                                       int (*action)(const Arguments&)) {
  options.push_back({"--store", "Database of runs [build/bench/store.sqlite]", &arguments->store});
  return Command{.name = name,
                 .summary = summary,
                 .example = "store " + example,
                 .options = std::move(options),
                 .action = [arguments, action] { return action(*arguments); },
                 .subcommands = {}};
}

}  // namespace stillpoint::bench
