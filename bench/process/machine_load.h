// SPDX-License-Identifier: BSD-3-Clause
/// Load of the machine during a timing measurement.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "bench/model/metrics.h"

namespace stillpoint::bench {

/// Processor time since boot [ticks of sysconf(_SC_CLK_TCK)], summed over all processors.
struct MachineLoad {
  std::int64_t busy = 0;
  std::int64_t total = 0;
};

[[nodiscard]] MachineLoad machine_load();

/// @param stat text of /proc/stat (proc(5)); user time includes guest time
[[nodiscard]] MachineLoad parse_machine_load(std::string_view stat);

/// The metrics of source `MetricSource::kMachine`: load by other processes between two measurements. Empty if
/// /proc/stat is not available.
/// @param own_s processor time of the timed process [s]
[[nodiscard]] std::vector<Metric> load_metrics(const MachineLoad& before, const MachineLoad& after,
                                               double own_s);

}  // namespace stillpoint::bench
