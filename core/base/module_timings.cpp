// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/module_timings.h"

namespace stillpoint {

std::string_view module_name(Module module) {
  static constexpr std::array<std::string_view, kModuleCount> kNames = {
      "feature_tracking",   "feature_detection",   "tracking_thread",  "dynamic_recognition",
      "state_optimization", "optimization_thread", "object_detection", "outlier_rejection",
      "feature_mask",       "window_solve",        "marginalization",  "image_decoding"};
  return kNames[static_cast<std::size_t>(module)];
}

}  // namespace stillpoint
