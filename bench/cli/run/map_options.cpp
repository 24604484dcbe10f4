// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/map_options.h"

#include "bench/record/map_file.h"
#include "bench/record/output_guard.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

OutputRules rules_of(const MapOptions& options) { return {.inputs = {options.load}, .beginning = kMapMagic}; }

}  // namespace

void require_map_options(const MapOptions& options, const OdometryConfig& config, std::size_t runs) {
  if (options.load.empty() && options.save.empty() && !options.final_ba) return;
  if (!config.loop.enabled) {
    const char* const option = !options.load.empty()  ? "--map"
                               : options.save.empty() ? "--final-ba"
                                                      : "--save-map";
    throw InputError(option, "requires loop closure; add --variant ablations/loop_closure");
  }
  if (options.save.empty()) return;
  if (runs > 1) throw InputError("--save-map", "requires a single run; pass one --variant");
  require_safe_output(options.save, rules_of(options));
}

std::shared_ptr<const KeyframeMap> load_map(const MapOptions& options) {
  return options.load.empty() ? nullptr : std::make_shared<KeyframeMap>(read_map(options.load));
}

void save_map(const MapOptions& options, const LoopReport& report) {
  if (options.save.empty()) return;
  if (!report.map) {
    throw InputError("--save-map",
                     "the run was not located in the map of --map, so it cannot extend it; run without --map "
                     "for a map of its own");
  }
  write_output(options.save, map_bytes(*report.map), rules_of(options));
}

}  // namespace stillpoint::bench
