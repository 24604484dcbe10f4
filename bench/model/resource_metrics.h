// SPDX-License-Identifier: BSD-3-Clause
/// Metrics of what a run uses: time and memory of the process, executed instructions, the load of the
/// machine, and its energy and throttling.
#pragma once

#include "bench/model/metrics.h"

namespace stillpoint::bench {

inline constexpr double kMaxQuietLoad = 0.05;  ///< more disturbs times measurably

[[nodiscard]] inline std::optional<double> process_wall(const Measurements& m) {
  return m.process ? std::optional<double>(m.process->wall_s) : std::nullopt;
}
[[nodiscard]] inline std::optional<double> process_cpu(const Measurements& m) {
  return m.process ? std::optional<double>(m.process->cpu_s) : std::nullopt;
}
[[nodiscard]] inline std::optional<double> peak_memory(const Measurements& m) {
  if (!m.process || !m.process->peak_memory_bytes) return std::nullopt;
  return static_cast<double>(*m.process->peak_memory_bytes) / 1048576.0;
}

[[nodiscard]] inline std::optional<double> other_load(const Measurements& m) { return m.other_load; }
[[nodiscard]] inline std::optional<double> quiet(const Measurements& m) {
  return m.other_load ? std::optional<double>(*m.other_load < kMaxQuietLoad ? 1.0 : 0.0) : std::nullopt;
}

[[nodiscard]] inline std::optional<double> instructions(const Measurements& m) {
  if (m.instructions.empty()) return std::nullopt;
  double sum = 0.0;
  for (const auto& [stage, executed] : m.instructions)
    sum += static_cast<double>(executed);  // exact below 2^53
  return sum;
}
[[nodiscard]] inline std::optional<double> stage_instructions(const Measurements& m, std::string_view stage) {
  const auto found = m.instructions.find(stage);
  return found == m.instructions.end() ? std::nullopt
                                       : std::optional<double>(static_cast<double>(found->second));
}

inline constexpr MetricProtocol kProcessProtocol{"", "wait4"};
inline constexpr MetricProtocol kInstructionProtocol{"", "valgrind callgrind, sequential, one thread"};

inline constexpr MetricDescriptor kCostMetrics[] = {
    {.id = "process_cpu_s",
     .label = "CPU time",
     .title = "CPU time per run",
     .description = "User and system time of all threads of the process",
     .unit = "s",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 2,
     .source = MetricSource::kProcess,
     .protocol = kProcessProtocol,
     .gate = MetricGate{MetricFamily::kCost, 0.03, 0.02, false},
     .value = process_cpu},
    {.id = "process_wall_s",
     .label = "process time",
     .description = "Time from start to end of the process",
     .unit = "s",
     .decimals = 2,
     .source = MetricSource::kProcess,
     .protocol = kProcessProtocol,
     .value = process_wall},
    {.id = "peak_memory_mb",
     .label = "peak memory",
     .title = "Peak memory per run",
     .description = "Largest resident memory of the process",
     .unit = "MB",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 1,
     .source = MetricSource::kProcess,
     .protocol = kProcessProtocol,
     // A process of tens of milliseconds is measured while it grows: 1.5 or 4.3 MB of one shell script.
     .gate = MetricGate{.family = MetricFamily::kCost,
                        .margin = 0.05,
                        .floor = 5.0,
                        .repeatable = false,
                        .absent_is_good = true},
     .value = peak_memory},
    // Counted, not timed: no measurement noise, but they also change with the compiler or a library update.
    {.id = "instructions",
     .label = "instructions",
     .description = "Executed instructions of all stages of the odometry",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 0,
     .source = MetricSource::kInstructions,
     .protocol = kInstructionProtocol,
     .gate = MetricGate{MetricFamily::kCost, 0.01, 0.0},
     .value = instructions},
    {.id = "instructions_tracking",
     .label = "instructions, tracking",
     .description = "Executed instructions of feature tracking",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 0,
     .source = MetricSource::kInstructions,
     .protocol = kInstructionProtocol,
     .gate = MetricGate{MetricFamily::kCost, 0.01, 0.0},
     .value = [](const Measurements& m) { return stage_instructions(m, "tracking"); }},
    {.id = "instructions_detection",
     .label = "instructions, detection",
     .description = "Executed instructions of object detection",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 0,
     .source = MetricSource::kInstructions,
     .protocol = kInstructionProtocol,
     .gate = MetricGate{MetricFamily::kCost, 0.01, 1e6},
     .value = [](const Measurements& m) { return stage_instructions(m, "detection"); }},
    {.id = "instructions_optimization",
     .label = "instructions, optimization",
     .description = "Executed instructions of state optimization",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 0,
     .source = MetricSource::kInstructions,
     .protocol = kInstructionProtocol,
     .gate = MetricGate{MetricFamily::kCost, 0.01, 0.0},
     .value = [](const Measurements& m) { return stage_instructions(m, "optimization"); }},
    {.id = metric_id::kOtherLoad,
     .label = "other load",
     .description = "Fraction of the CPU time of the machine that other processes used during the run",
     .source = MetricSource::kMachine,
     .protocol = {"", "/proc/stat"},
     .value = other_load},
    {.id = metric_id::kQuiet,
     .label = "quiet",
     .description = "1 if other processes used less than 5 % of the CPU during the run, else 0",
     .decimals = 0,
     .source = MetricSource::kMachine,
     .protocol = {"", "other_load below 0.05"},
     .value = quiet},
};

/// The value of one member of `DeviceScore`; nullopt where it could not be measured.
template <auto kMember>
[[nodiscard]] std::optional<double> device_value(const Measurements& m) {
  return m.device ? (*m.device).*kMember : std::nullopt;
}

inline constexpr MetricDescriptor kDeviceMetrics[] = {
    {.id = "energy_j_per_frame",
     .label = "energy",
     .title = "Energy per frame, above idle",
     .description =
         "Energy of the machine during the run, less idle power times duration, per processed frame",
     .unit = "J",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kDevice,
     .value = device_value<&DeviceScore::joules_per_frame>},
    {.id = "energy_j_per_frame_sd",
     .label = "energy, sd",
     .description = "Standard deviation of the energy per frame over intervals of 1 s",
     .unit = "J",
     .source = MetricSource::kDevice,
     .value = device_value<&DeviceScore::joules_per_frame_sd>},
    {.id = "power_w",
     .label = "power",
     .description = "Mean power of the machine during the run",
     .unit = "W",
     .decimals = 2,
     .source = MetricSource::kDevice,
     .value = device_value<&DeviceScore::power_w>},
    {.id = "idle_power_w",
     .label = "idle power",
     .description = "Mean power of the machine in the second before the run",
     .unit = "W",
     .decimals = 2,
     .source = MetricSource::kDevice,
     .value = device_value<&DeviceScore::idle_w>},
    {.id = "energy_rate_hz",
     .label = "energy samples",
     .description = "Rate at which the energy was sampled; below 10 Hz there is no result",
     .unit = "Hz",
     .decimals = 1,
     .source = MetricSource::kDevice,
     .value = device_value<&DeviceScore::energy_rate_hz>},
    {.id = "throttled",
     .label = "throttled",
     .description = "1 if temperature or power limited the processor during the run, else 0",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 0,
     .source = MetricSource::kDevice,
     .value = device_value<&DeviceScore::throttled>},
    {.id = "temperature_c",
     .label = "temperature",
     .description = "Temperature of the hottest thermal zone at the end of the run",
     .unit = "deg C",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 1,
     .source = MetricSource::kDevice,
     .value = device_value<&DeviceScore::temperature_c>},
};

}  // namespace stillpoint::bench
