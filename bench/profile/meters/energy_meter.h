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

/// Adds the differences of energy counters. Without them power samples are integrated as piecewise
/// constant: E = sum_k P_k (t_{k+1} - t_k), P_k = power [W] at time t_k [s].
class EnergyMeter {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// @param root       "/", or a folder with a recorded "sys"
  /// @param tegrastats log of a running `tegrastats`, for devices whose sensors are not readable; empty for
  ///                   none
  EnergyMeter(std::filesystem::path root, std::filesystem::path tegrastats, Time now);

  /// Must be called more often than a counter wraps around, which takes a minute at high power.
  void sample(Time now);

  /// Energy from the construction to the last sample; nothing without a source, or if any reading since then
  /// was not valid.
  [[nodiscard]] std::optional<EnergyUse> so_far() const;

  /// Samples; then as `so_far`.
  [[nodiscard]] std::optional<EnergyUse> use(Time now);

 private:
  /// Power by the first available source, sensors first; sets `source_`.
  [[nodiscard]] std::optional<double> power_w();

  std::filesystem::path root_;
  std::filesystem::path tegrastats_;
  std::string source_;
  std::vector<EnergyCounter> counters_;  ///< at the last sample; empty if power is sampled
  Time last_;
  std::optional<double> power_w_;  ///< at `last_`
  bool is_valid_ = true;
  double joules_ = 0.0;
};

}  // namespace stillpoint::bench
