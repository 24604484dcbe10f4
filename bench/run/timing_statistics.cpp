// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/timing_statistics.h"

#include <algorithm>

#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

double milliseconds(std::int64_t ns, std::int64_t calls) {
  return static_cast<double>(ns) / static_cast<double>(calls) * 1e-6;
}

}  // namespace

bool is_thread(Module module) {
  return module == Module::kTrackingThread || module == Module::kOptimizationThread;
}

void TimingSamples::add(Module module, const ModuleTime& frame) {
  if (frame.calls > 0) frames_[static_cast<std::size_t>(module)].push_back(frame);
}

std::optional<TimingStatistics> TimingSamples::statistics(Module module) const {
  return statistics(module, is_thread(module) ? TimePer::kFrame : TimePer::kCall);
}

std::optional<TimingStatistics> TimingSamples::statistics(Module module, TimePer per) const {
  std::vector<double> samples_ms;
  ModuleTime total;
  for (const ModuleTime& frame : frames_[static_cast<std::size_t>(module)]) {
    samples_ms.push_back(milliseconds(frame.ns, per == TimePer::kFrame ? 1 : frame.calls));
    total.ns += frame.ns;
    total.calls += frame.calls;
  }
  if (samples_ms.empty()) return std::nullopt;
  const auto frames = static_cast<std::int64_t>(samples_ms.size());
  return TimingStatistics{.mean = milliseconds(total.ns, per == TimePer::kFrame ? frames : total.calls),
                          .median = eval::percentile(samples_ms, 0.5).value(),
                          .p95 = eval::percentile(samples_ms, 0.95).value(),
                          .p99 = eval::percentile(samples_ms, 0.99).value(),
                          .max = *std::max_element(samples_ms.begin(), samples_ms.end()),
                          .calls = total.calls};
}

std::int64_t TimingSamples::frames_over(Module module, double budget_ms) const {
  const std::vector<ModuleTime>& frames = frames_[static_cast<std::size_t>(module)];
  return std::count_if(frames.begin(), frames.end(),
                       [&](const ModuleTime& frame) { return milliseconds(frame.ns, 1) > budget_ms; });
}

}  // namespace stillpoint::bench
