// SPDX-License-Identifier: BSD-3-Clause
/// Summaries of the time spent in each module, as in the paper's Table III.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <vector>

#include "core/base/module_timings.h"

namespace stillpoint {

/// [ms]; modules per call, threads per frame.
struct TimingStatistics {
  double mean = 0.0;
  double median = 0.0;
  double p95 = 0.0;  ///< percentiles are linear between ranks
  double p99 = 0.0;
  double max = 0.0;
  std::int64_t calls = 0;
};

/// Whether a module is a whole thread of the paper, whose time is counted per frame.
[[nodiscard]] bool is_thread(Module module);

/// What a sample is: the mean of a frame's calls, or all that the frame spent. Frames without a call are
/// left out of both.
enum class TimePer { kCall, kFrame };

/// What every frame of a run spent, module by module.
class TimingSamples {
 public:
  /// Adds what one frame spent in a module; nothing if it was not called.
  void add(Module module, const ModuleTime& frame);

  /// As the paper counts: threads per frame, the others per call. Nothing for a module that was never called.
  [[nodiscard]] std::optional<TimingStatistics> statistics(Module module) const;
  [[nodiscard]] std::optional<TimingStatistics> statistics(Module module, TimePer per) const;

  /// Frames that spent more than `budget_ms` in a module.
  [[nodiscard]] std::int64_t frames_beyond(Module module, double budget_ms) const;

 private:
  std::array<std::vector<ModuleTime>, kModuleCount> frames_;
};

}  // namespace stillpoint
