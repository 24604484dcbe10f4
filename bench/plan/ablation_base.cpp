// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/ablation_base.h"

#include <algorithm>

#include "bench/config/setting.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

bool contains(std::span<const std::string> names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The longest variant that `variant` extends by overlays, else `base`.
std::string base_of(const std::string& variant, const std::string& base,
                    std::span<const std::string> variants) {
  for (std::size_t plus = variant.rfind('+'); plus != std::string::npos && plus > 0;
       plus = variant.rfind('+', plus - 1)) {
    if (contains(variants, variant.substr(0, plus))) return variant.substr(0, plus);
  }
  return base;
}

}  // namespace

std::optional<std::string> ablation_base_of(const StoredPlan& plan) {
  try {
    for (const Setting& setting : parse_settings(plan.text, "plan " + plan.name)) {
      const auto* base = std::get_if<std::string>(&setting.value);
      if (setting.key == "ablation_base" && base != nullptr && !base->empty()) return *base;
    }
  } catch (const InputError&) {
    return std::nullopt;  // written by hand or by another version; the runs are valid without it
  }
  return std::nullopt;
}

std::vector<AblationGroup> ablation_groups(const std::string& base, std::span<const std::string> variants) {
  if (!contains(variants, base)) return {};
  std::vector<AblationGroup> groups = {{.base = base, .variants = {}}};
  for (const std::string& variant : variants) {
    if (variant == base) continue;
    const std::string own = base_of(variant, base, variants);
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const AblationGroup& known) { return known.base == own; });
    if (group == groups.end()) group = groups.insert(groups.end(), {.base = own, .variants = {}});
    group->variants.push_back(variant);
  }
  std::erase_if(groups, [](const AblationGroup& group) { return group.variants.empty(); });
  return groups;
}

}  // namespace stillpoint::bench
