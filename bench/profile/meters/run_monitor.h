// SPDX-License-Identifier: BSD-3-Clause
/// Energy per frame and throttling during a run.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "bench/model/metrics.h"
#include "bench/profile/meters/device_info.h"

namespace stillpoint::bench {

/// Energy consumption of the machine during a measurement.
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

/// State of a run at one moment.
struct EnergySample {
  double t_s = 0.0;     ///< since the start of the run
  double joules = 0.0;  ///< of the machine, since then
  std::int64_t frames = 0;
};

/// Lowest rate of valid results [Hz].
inline constexpr double kLowestEnergyRateHz = 10.0;

/// Energy per frame above idle: (E - P_idle T) / n with the energy E [J], the duration T [s], and n frames;
/// its spread is the standard deviation of that quotient over intervals of 1 s. Values are left out with less
/// than two samples, without frames, at a rate below `kLowestEnergyRateHz`, and if the run used less than
/// idle.
/// @param idle_w power before the run
[[nodiscard]] DeviceScore energy_score(std::span<const EnergySample> samples, double idle_w);

/// Mean power over one second, which the caller leaves idle [W]; nothing as for `EnergyMeter::so_far`, then
/// at once.
/// @param root, tegrastats as for `EnergyMeter`
[[nodiscard]] std::optional<double> idle_power_w(const std::filesystem::path& root,
                                                 const std::filesystem::path& tegrastats);

/// Measures idle power when it is constructed, for 1 s, if the machine has readable power rails or counters;
/// then a thread samples the energy 20 times per second until `finish`. Without, it only compares throttling.
class RunMonitor {
 public:
  /// @param root "/", or a folder with a recorded "sys"; empty: nothing is measured, as for instruction
  /// counts
  explicit RunMonitor(std::filesystem::path root);
  ~RunMonitor() = default;
  RunMonitor(const RunMonitor&) = delete;
  RunMonitor& operator=(const RunMonitor&) = delete;

  void frame_done() { ++frames_; }

  /// Nothing if neither energy nor throttling can be read. The energy is left out if any reading during the
  /// run was not valid.
  [[nodiscard]] std::optional<DeviceScore> finish();

 private:
  using Clock = std::chrono::steady_clock;

  /// @return whether to go on
  bool wait_until(Clock::time_point time, const std::stop_token& stop);
  void sample_until_stopped(const std::stop_token& stop);
  void add_sample(Clock::time_point now);

  std::filesystem::path root_;
  std::optional<double> idle_w_;
  ThrottleState before_;
  bool throttled_ = false;
  std::atomic<std::int64_t> frames_ = 0;
  std::mutex mutex_;
  std::condition_variable_any stopped_;
  Clock::time_point start_;
  std::optional<EnergyMeter> meter_;  ///< used by the thread until it ends
  std::vector<EnergySample> samples_;
  bool is_valid_ = true;
  std::jthread thread_;  ///< the last member: it uses the others
};

}  // namespace stillpoint::bench
