// SPDX-License-Identifier: BSD-3-Clause
/// Metrics of energy and throttling.
#pragma once

#include "bench/model/metrics.h"

namespace stillpoint::bench {

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
