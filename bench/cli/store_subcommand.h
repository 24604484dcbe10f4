// SPDX-License-Identifier: BSD-3-Clause
/// The shape that all subcommands of `store` share.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/cli/command.h"

namespace stillpoint {

/// @param example   without the word `store`
/// @param options   but for `--store`, which is added
/// @param arguments where they go; it has a member `store`
template <class Arguments>
[[nodiscard]] Command store_subcommand(const std::string& name, const std::string& summary,
                                       const std::string& example, std::vector<Option> options,
                                       const std::shared_ptr<Arguments>& arguments,
                                       int (*action)(const Arguments&)) {
  options.push_back({"--store", "The store [build/bench/store.sqlite]", &arguments->store});
  return Command{.name = name,
                 .summary = summary,
                 .example = "store " + example,
                 .options = std::move(options),
                 .action = [arguments, action] { return action(*arguments); },
                 .subcommands = {}};
}

}  // namespace stillpoint
