// SPDX-License-Identifier: BSD-3-Clause
/// How busy the machine was while something was timed.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "bench/store/stored_run.h"

namespace stillpoint {

/// Processor time since the machine started [ticks of sysconf(_SC_CLK_TCK)], summed over its processors.
struct MachineLoad {
  std::int64_t busy = 0;
  std::int64_t total = 0;
};

[[nodiscard]] MachineLoad machine_load();

/// @param stat text of /proc/stat (proc(5)); time of guests is within user time already
[[nodiscard]] MachineLoad parse_machine_load(std::string_view stat);

/// Adds "other_load", the share of the machine that others took between two moments, and "quiet": 1 if that
/// was below 5 %, else 0. Nothing where the system does not tell.
/// @param own_s processor time that the timed process took [s]
void append_load(std::vector<Metric>& metrics, const MachineLoad& before, const MachineLoad& after,
                 double own_s);

}  // namespace stillpoint
