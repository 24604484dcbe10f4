// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/missing_boxes.h"

#include <fmt/format.h>

#include "bench/model/metrics.h"

namespace stillpoint::bench {

std::string missing_boxes_note(const std::vector<const StoredRun*>& runs) {
  const StoredRun* worst = nullptr;
  double most = 0.0;
  for (const StoredRun* run : runs) {
    const double missing = metric_value(*run, metric_id::kFramesWithoutBoxes).value_or(0.0);
    if (run->outcome != Outcome::kOk || missing <= most) continue;
    worst = run;
    most = missing;
  }
  if (worst == nullptr) return "";
  const std::optional<double> frames = metric_value(*worst, metric_id::kFrames);
  return fmt::format("no recorded boxes in {}{:.0f}{} frames", runs.size() > 1 ? "up to " : "", most,
                     frames ? fmt::format(" of {:.0f}", *frames) : "");
}

}  // namespace stillpoint::bench
