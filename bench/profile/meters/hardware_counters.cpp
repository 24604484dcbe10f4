// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/hardware_counters.h"

#include <cerrno>
#include <cstring>

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace stillpoint::bench {
namespace {

struct Event {
  const char* name;
  std::uint64_t config;
};
constexpr Event kEvents[] = {{"cycles", PERF_COUNT_HW_CPU_CYCLES},
                             {"instructions", PERF_COUNT_HW_INSTRUCTIONS},
                             {"cache_misses", PERF_COUNT_HW_CACHE_MISSES},
                             {"branch_misses", PERF_COUNT_HW_BRANCH_MISSES}};

int open_counter(const Event& event) {
  perf_event_attr attributes{};
  attributes.type = PERF_TYPE_HARDWARE;
  attributes.size = sizeof attributes;
  attributes.config = event.config;
  attributes.inherit = 1;
  attributes.exclude_kernel = 1;
  attributes.exclude_hv = 1;
  return static_cast<int>(syscall(SYS_perf_event_open, &attributes, 0, -1, -1, PERF_FLAG_FD_CLOEXEC));
}

}  // namespace

HardwareCounters::HardwareCounters() {
  for (const Event& event : kEvents) {
    const int descriptor = open_counter(event);
    if (descriptor >= 0) {
      counters_.push_back({event.name, descriptor});
    } else if (reason_.empty()) {
      reason_ = describe_counter_error(errno);
    }
  }
  if (!counters_.empty()) reason_.clear();
}

HardwareCounters::~HardwareCounters() {
  for (const Counter& counter : counters_) close(counter.descriptor);
}

std::vector<HardwareCount> HardwareCounters::counts() const {
  std::vector<HardwareCount> counts;
  for (const Counter& counter : counters_) {
    std::int64_t count = 0;
    if (read(counter.descriptor, &count, sizeof count) == sizeof count)
      counts.push_back({counter.name, count});
  }
  return counts;
}

std::string describe_counter_error(int error_number) {
  switch (error_number) {
    case ENOENT:
    case ENODEV:
    case EOPNOTSUPP:
      return "this machine has none; virtual machines often hide them";
    case EACCES:
    case EPERM:
      return "not permitted; see /proc/sys/kernel/perf_event_paranoid";
    case ENOSYS:
      return "this kernel has no perf_event_open";
    default:
      return std::strerror(error_number);
  }
}

}  // namespace stillpoint::bench
