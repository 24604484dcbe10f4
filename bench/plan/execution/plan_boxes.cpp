// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/plan_boxes.h"

#include "bench/run/recorded_boxes.h"
#include "core/base/error.h"

namespace stillpoint::bench {

void require_recorded_boxes(const PlanMatrix& matrix) {
  for (const PlannedRun& run : matrix.runs) {
    const PlanSequence& sequence = matrix.sequences[run.sequence];
    const bool is_own = run.identity.mode != "external" && run.program.empty();
    if (!is_own || sequence.rendering || !sequence.unavailable_reason.empty()) continue;
    try {
      require_recorded_boxes(load_config(run.config), sequence.folder);
    } catch (const InputError& error) {
      throw InputError("run \"" + run_label(matrix.plan, run.identity) + "\"", error.what());
    }
  }
}

}  // namespace stillpoint::bench
