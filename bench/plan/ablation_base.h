// SPDX-License-Identifier: BSD-3-Clause
/// The base of a stored plan's ablation, and the variants that are compared with it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/store/store.h"

namespace stillpoint::bench {

/// The key `ablation_base` of a plan, from its stored text.
/// @return nullopt without that key, as in plans of older versions, or if the text is not valid TOML
[[nodiscard]] std::optional<std::string> ablation_base_of(const StoredPlan& plan);

/// Variants that are compared with the same base.
struct AblationGroup {
  std::string base;
  std::vector<std::string> variants;  ///< without the base, in the order of the plan
};

/// Assigns each variant of a plan to its base: "a+b+c" is compared with "a+b" if the plan contains it, else
/// with "a" if the plan contains it, else with the base of the plan. An overlay of another system is so never
/// compared with the system of the plan's base.
/// @param variants of the plan, each once
/// @return the group of the plan's base first; groups without variants are omitted; none if `variants` does
/// not contain `base`
[[nodiscard]] std::vector<AblationGroup> ablation_groups(const std::string& base,
                                                         std::span<const std::string> variants);

}  // namespace stillpoint::bench
