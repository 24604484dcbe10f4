// SPDX-License-Identifier: BSD-3-Clause
#include "bench/process/machine_load.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include <unistd.h>

namespace stillpoint::bench {
namespace {

constexpr int kIdle = 3;     // column of /proc/stat, after user, nice, system
constexpr int kIoWait = 4;   // also idle
constexpr int kColumns = 8;  // up to steal

}  // namespace

MachineLoad parse_machine_load(std::string_view stat) {
  std::istringstream stream{std::string(stat)};
  std::string label;
  stream >> label;
  MachineLoad load;
  if (label != "cpu") return load;
  std::int64_t ticks = 0;
  for (int column = 0; column < kColumns && stream >> ticks; ++column) {
    load.total += ticks;
    if (column != kIdle && column != kIoWait) load.busy += ticks;
  }
  return load;
}

MachineLoad machine_load() {
  std::ostringstream text;
  text << std::ifstream("/proc/stat").rdbuf();
  return parse_machine_load(text.str());
}

std::vector<Metric> load_metrics(const MachineLoad& before, const MachineLoad& after, double own_s) {
  const auto total = static_cast<double>(after.total - before.total);
  if (total <= 0.0) return {};
  const double own = own_s * static_cast<double>(sysconf(_SC_CLK_TCK));
  return measured_metrics(
      {.other_load = std::max(0.0, (static_cast<double>(after.busy - before.busy) - own) / total)});
}

}  // namespace stillpoint::bench
