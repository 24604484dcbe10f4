// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/bench_plan.h"

#include "bench/config/apply_settings.h"
#include "bench/config/config_file.h"
#include "bench/config/toml_source.h"

namespace stillpoint {
namespace {

void require_variants(const std::vector<std::string>& variants) {
  for (const std::string& variant : variants) {
    static_cast<void>(load_config({.base = "stillpoint", .variant = variant, .settings = {}}));
  }
}

}  // namespace

BenchPlan load_plan(const std::string& name) {
  const TomlSource source = find_toml(name, TomlFamily::kPlan);
  const BenchPlan plan = with_settings(BenchPlan{}, parse_settings(source.text, source.place));
  require_variants(plan.rendered.variants);
  require_variants(plan.recorded.variants);
  return plan;
}

}  // namespace stillpoint
