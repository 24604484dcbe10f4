// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/process_usage.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include <linux/perf_event.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

ProcessUsage process_usage() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {.user_s = seconds(usage.ru_utime),
          .system_s = seconds(usage.ru_stime),
          .voluntary_switches = usage.ru_nvcsw,
          .involuntary_switches = usage.ru_nivcsw,
          .minor_faults = usage.ru_minflt,
          .major_faults = usage.ru_majflt,
          .peak_memory_bytes = usage.ru_maxrss * 1024};
}

ProcessUsage usage_between(const ProcessUsage& before, const ProcessUsage& after) {
  return {.user_s = after.user_s - before.user_s,
          .system_s = after.system_s - before.system_s,
          .voluntary_switches = after.voluntary_switches - before.voluntary_switches,
          .involuntary_switches = after.involuntary_switches - before.involuntary_switches,
          .minor_faults = after.minor_faults - before.minor_faults,
          .major_faults = after.major_faults - before.major_faults,
          .peak_memory_bytes = after.peak_memory_bytes};
}

double process_age_s() {
  std::ifstream file("/proc/self/stat");
  std::string fields;
  std::getline(file, fields);
  std::istringstream values(fields.substr(std::min(fields.size(), fields.rfind(')') + 1)));
  std::string skipped;
  constexpr int kFieldsBetween = 19;  // from state (3) to itrealvalue (21), see proc(5)
  for (int i = 0; i < kFieldsBetween; ++i) values >> skipped;
  double start_ticks = 0.0;  // since the boot
  timespec now{};
  if (!(values >> start_ticks) || clock_gettime(CLOCK_BOOTTIME, &now) != 0) return 0.0;
  const double now_s = static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  return std::max(0.0, now_s - start_ticks / static_cast<double>(sysconf(_SC_CLK_TCK)));
}

std::map<int, ThreadUsage> thread_usages() {
  std::map<int, ThreadUsage> threads;
  const auto ticks_per_s = static_cast<double>(sysconf(_SC_CLK_TCK));
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(entry.path() / "stat");
    std::string stat;
    std::getline(file, stat, '\0');  // whose errors are no exceptions
    if (stat.empty()) continue;      // the thread has exited meanwhile
    threads[std::stoi(entry.path().filename())] = parse_thread_stat(stat, ticks_per_s);
  }
  return threads;
}

ThreadUsage parse_thread_stat(const std::string& stat, double ticks_per_s) {
  // The name is in parentheses and may itself contain spaces and parentheses.
  const std::size_t open = stat.find('(');
  const std::size_t close = stat.rfind(')');
  if (open == std::string::npos || close == std::string::npos || close < open) {
    throw InputError("/proc/self/task", "has no thread name; see proc(5) for the format");
  }
  std::istringstream fields(stat.substr(close + 1));
  std::string skipped;
  constexpr int kFieldsBetween = 11;  // from state (3) to cmajflt (13)
  for (int i = 0; i < kFieldsBetween; ++i) fields >> skipped;
  double user = 0.0;
  double system = 0.0;
  if (!(fields >> user >> system)) {
    throw InputError("/proc/self/task", "has no thread times; see proc(5) for the format");
  }
  return {.name = stat.substr(open + 1, close - open - 1),
          .user_s = user / ticks_per_s,
          .system_s = system / ticks_per_s};
}

void pin_to(const std::vector<int>& processors) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int processor : processors) CPU_SET(static_cast<std::size_t>(processor), &set);
  if (sched_setaffinity(0, sizeof set, &set) != 0) {
    throw InputError("--cores", "none of these processors is available to this process; see `nproc`");
  }
}

nlohmann::ordered_json usage_json(const ProcessUsage& usage, const std::map<int, ThreadUsage>& threads) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [id, thread] : threads) {
    list.push_back(
        {{"id", id}, {"name", thread.name}, {"user_s", thread.user_s}, {"system_s", thread.system_s}});
  }
  return {{"user_s", usage.user_s},
          {"system_s", usage.system_s},
          {"voluntary_switches", usage.voluntary_switches},
          {"involuntary_switches", usage.involuntary_switches},
          {"minor_faults", usage.minor_faults},
          {"major_faults", usage.major_faults},
          {"peak_memory_bytes", usage.peak_memory_bytes},
          {"threads", list}};
}

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
