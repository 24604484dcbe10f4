// SPDX-License-Identifier: BSD-3-Clause
/// Timing model of a target device.
#pragma once

#include <optional>

namespace stillpoint {

/// Execution time of one call of a stage on the device.
struct StageCost {
  std::optional<double> fixed_ms;  ///< constant time; the optimization stage then takes no time for a frame
                                   ///< that does not enter the window
  double factor = 1.0;             ///< without `fixed_ms`: multiple of the time measured on this machine
};

struct DeviceModel {
  int cores = 2;                            ///< stages that can run at the same time, >= 1
  bool detector_has_own_processor = false;  ///< detection occupies no core
  StageCost tracking;
  StageCost detection;
  StageCost optimization;
  [[nodiscard]] bool is_deterministic() const {
    return tracking.fixed_ms && detection.fixed_ms && optimization.fixed_ms;
  }
};

}  // namespace stillpoint
