// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/energy_meter.h"

#include <utility>

namespace stillpoint::bench {

EnergyMeter::EnergyMeter(std::filesystem::path root, std::filesystem::path tegrastats, Time now)
    : root_(std::move(root)), tegrastats_(std::move(tegrastats)), start_(read_rapl(root_)), last_(now) {
  if (start_.empty()) sample(now);
}

std::vector<RailPower> EnergyMeter::rails() {
  std::vector<RailPower> found = read_ina3221(root_);
  source_ = "INA3221";
  if (!found.empty() || tegrastats_.empty()) return found;
  source_ = "tegrastats";
  return read_tegrastats(tegrastats_);
}

void EnergyMeter::sample(Time now) {
  if (!start_.empty()) return;
  const std::vector<RailPower> current = rails();
  if (current.empty()) return;
  joules_ += power_w_ * std::chrono::duration<double>(now - last_).count();
  power_w_ = device_power_w(current);
  last_ = now;
  has_power_ = true;
}

std::optional<EnergyUse> EnergyMeter::use(Time now) {
  if (!start_.empty()) return EnergyUse{joules_between(start_, read_rapl(root_)), "RAPL"};
  sample(now);
  if (!has_power_) return std::nullopt;
  return EnergyUse{joules_, source_};
}

}  // namespace stillpoint::bench
