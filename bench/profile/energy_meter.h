// SPDX-License-Identifier: BSD-3-Clause
/// Energy of the machine while something runs.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/profile/energy_files.h"

namespace stillpoint {

struct EnergyUse {
  double joules = 0.0;  ///< of the whole machine or processor, not of this program alone
  std::string source;   ///< "RAPL", "INA3221" or "tegrastats"
};

/// Counters are read at both ends, power whenever asked to, and taken as constant in between.
class EnergyMeter {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// @param root       "/", or a folder with a recorded "sys"
  /// @param tegrastats a log that `tegrastats` goes on writing, for boards whose sensors may not be read;
  ///                   empty for none
  EnergyMeter(std::filesystem::path root, std::filesystem::path tegrastats, Time now);

  /// Takes a sample of the power, where there are no counters.
  void look(Time now);

  /// Since the construction; nothing where the machine tells neither.
  [[nodiscard]] std::optional<EnergyUse> use(Time now);

 private:
  /// Rails of whichever tells them, the sensors first; names it in `source_`.
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

}  // namespace stillpoint
