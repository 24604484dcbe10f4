// SPDX-License-Identifier: BSD-3-Clause
/// Energy consumption of the machine during a measurement.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/profile/meters/energy_files.h"

namespace stillpoint::bench {

struct EnergyUse {
  double joules = 0.0;  ///< of the whole machine or processor, not only of this process
  std::string source;   ///< "RAPL", "INA3221" or "tegrastats"
};

/// Energy counters are read at start and end. Without them power samples are integrated as piecewise
/// constant: E = sum_k P_k (t_{k+1} - t_k), P_k = power [W] at time t_k [s].
class EnergyMeter {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// @param root       "/", or a folder with a recorded "sys"
  /// @param tegrastats log of a running `tegrastats`, for devices whose sensors are not readable; empty for
  ///                   none
  EnergyMeter(std::filesystem::path root, std::filesystem::path tegrastats, Time now);

  /// Samples the power, unless there are energy counters.
  void sample(Time now);

  /// Energy since construction; nothing if neither energy nor power is available.
  [[nodiscard]] std::optional<EnergyUse> use(Time now);

 private:
  /// Rails of the first available source, sensors first; sets `source_`.
  [[nodiscard]] std::vector<RailPower> rails();

  std::filesystem::path root_;
  std::filesystem::path tegrastats_;
  std::string source_;
  std::vector<EnergyCounter> start_;
  Time last_;
  double power_w_ = 0.0;  ///< at `last_`
  bool has_power_ = false;
  double joules_ = 0.0;
};

}  // namespace stillpoint::bench
