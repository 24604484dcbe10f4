// SPDX-License-Identifier: BSD-3-Clause
/// Statistics of the time per module, as in Paper Table III.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <vector>

#include "core/base/module_timings.h"

namespace stillpoint::bench {

/// [ms]; modules per call, threads per frame.
struct TimingStatistics {
  double mean = 0.0;
  double median = 0.0;
  double p95 = 0.0;  ///< percentiles interpolate linearly between ranks
  double p99 = 0.0;
  double max = 0.0;
  std::int64_t calls = 0;
};

/// Whether a module is a whole thread of the paper, whose time is reported per frame.
[[nodiscard]] bool is_thread(Module module);

/// Sample of the statistics: the mean time of a frame's calls, or the total time of the frame. Frames without
/// a call are excluded from both.
enum class TimePer { kCall, kFrame };

/// Time per frame and module of a run.
class TimingSamples {
 public:
  /// Adds the time of one frame in a module; ignored without calls.
  void add(Module module, const ModuleTime& frame);

  /// As in the paper: threads per frame, other modules per call. Nothing for a module that was never called.
  [[nodiscard]] std::optional<TimingStatistics> statistics(Module module) const;
  [[nodiscard]] std::optional<TimingStatistics> statistics(Module module, TimePer per) const;

  /// Number of frames that spent more than `budget_ms` in a module.
  [[nodiscard]] std::int64_t frames_over(Module module, double budget_ms) const;

 private:
  std::array<std::vector<ModuleTime>, kModuleCount> frames_;
};

}  // namespace stillpoint::bench
