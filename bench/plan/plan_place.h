// SPDX-License-Identifier: BSD-3-Clause
/// Adds the line of a plan file to errors about what the line refers to.
#pragma once

#include <string>

#include "bench/plan/bench_plan.h"
#include "core/base/error.h"

namespace stillpoint::bench {

/// Place of a key in messages: "plan.toml:3"; the file alone, or the name of the plan, if the key is not set.
[[nodiscard]] inline std::string place_of(const BenchPlan& plan, const std::string& key) {
  const auto found = plan.places.find(key);
  if (found != plan.places.end()) return found->second;
  return plan.path.empty() ? "plan \"" + plan.name + "\"" : plan.path;
}

/// Result of `action`.
/// @throws InputError the error of `action`, preceded by the place of the key
template <class Action>
decltype(auto) at_place(const BenchPlan& plan, const std::string& key, const Action& action) {
  try {
    return action();
  } catch (const InputError& error) {
    throw InputError(place_of(plan, key), error.what());
  }
}

}  // namespace stillpoint::bench
