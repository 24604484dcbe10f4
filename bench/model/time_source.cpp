// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/time_source.h"

#include "bench/model/metrics.h"

namespace stillpoint::bench {

TimeSource time_source(const StoredRun& run) {
  if (run.identity.kind != "timing") return TimeSource::kShared;
  return metric_value(run, metric_id::kQuiet) == 0.0 ? TimeSource::kBusy : TimeSource::kUndisturbed;
}

std::string time_source_note(TimeSource source) {
  switch (source) {
    case TimeSource::kUndisturbed:
      return "";
    case TimeSource::kBusy:
      return "times of timing runs while other processes used at least 5 % of the CPU: indicative only; "
             "repeat the runs on an idle machine";
    case TimeSource::kShared:
      return "times of runs that are no timing runs and may have shared the machine: indicative only; "
             "execute a plan with kind = \"timing\"";
  }
  return "";
}

}  // namespace stillpoint::bench
