// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/energy_meter.h"

#include <utility>

namespace stillpoint::bench {

EnergyMeter::EnergyMeter(std::filesystem::path root, std::filesystem::path tegrastats, Time now)
    : root_(std::move(root)), tegrastats_(std::move(tegrastats)), source_("RAPL"), last_(now) {
  counters_ = read_rapl(root_);
  if (joules_between(counters_, counters_)) return;
  counters_.clear();
  power_w_ = power_w();
  is_valid_ = power_w_.has_value();
}

std::optional<double> EnergyMeter::power_w() {
  source_ = "INA3221";
  const std::vector<RailPower> sensors = read_power_sensors(root_);
  if (!sensors.empty() || tegrastats_.empty()) return device_power_w(sensors);
  source_ = "tegrastats";
  return device_power_w(read_tegrastats(tegrastats_));
}

void EnergyMeter::sample(Time now) {
  if (!is_valid_) return;
  std::optional<double> joules;
  if (!counters_.empty()) {
    std::vector<EnergyCounter> counters = read_rapl(root_);
    joules = joules_between(counters_, counters);
    counters_ = std::move(counters);
  } else {
    joules = *power_w_ * std::chrono::duration<double>(now - last_).count();
    power_w_ = power_w();
    if (!power_w_) joules.reset();
  }
  last_ = now;
  is_valid_ = joules.has_value();
  if (joules) joules_ += *joules;
}

std::optional<EnergyUse> EnergyMeter::so_far() const {
  if (!is_valid_) return std::nullopt;
  return EnergyUse{joules_, source_};
}

std::optional<EnergyUse> EnergyMeter::use(Time now) {
  sample(now);
  return so_far();
}

}  // namespace stillpoint::bench
