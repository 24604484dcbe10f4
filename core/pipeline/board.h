// SPDX-License-Identifier: BSD-3-Clause
/// Another machine, as far as the timing of the stages is concerned.
#pragma once

#include <optional>

namespace stillpoint {

/// What one call of a stage takes there.
struct StageCost {
  std::optional<double> fixed_ms;  ///< always so long; a picture that does not enter the window costs the
                                   ///< optimisation nothing then
  double factor = 1.0;             ///< otherwise so many times what it took here
};

struct BoardModel {
  int cores = 2;                            ///< stages that can be at work at a time, >= 1
  bool detector_has_own_processor = false;  ///< it takes no core
  StageCost tracking;
  StageCost detection;
  StageCost optimization;
  [[nodiscard]] bool is_deterministic() const {
    return tracking.fixed_ms && detection.fixed_ms && optimization.fixed_ms;
  }
};

}  // namespace stillpoint
