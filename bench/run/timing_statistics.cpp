// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/timing_statistics.h"

#include <algorithm>

#include "eval/metrics/statistics.h"

namespace stillpoint {
namespace {

double milliseconds(std::int64_t ns, std::int64_t calls) {
  return static_cast<double>(ns) / static_cast<double>(calls) * 1e-6;
}

}  // namespace

bool is_thread(Module module) {
  return module == Module::kTrackingThread || module == Module::kOptimizationThread;
}

void TimingSamples::add(Module module, const ModuleTime& frame) {
  if (frame.calls == 0) return;
  const auto index = static_cast<std::size_t>(module);
  samples_ms_[index].push_back(milliseconds(frame.ns, is_thread(module) ? 1 : frame.calls));
  totals_[index].ns += frame.ns;
  totals_[index].calls += frame.calls;
}

std::optional<TimingStatistics> TimingSamples::statistics(Module module) const {
  const std::vector<double>& samples = samples_ms_[static_cast<std::size_t>(module)];
  if (samples.empty()) return std::nullopt;
  const ModuleTime& total = totals_[static_cast<std::size_t>(module)];
  const auto frames = static_cast<std::int64_t>(samples.size());
  return TimingStatistics{.mean = milliseconds(total.ns, is_thread(module) ? frames : total.calls),
                          .median = percentile(samples, 0.5).value(),
                          .p95 = percentile(samples, 0.95).value(),
                          .max = *std::max_element(samples.begin(), samples.end()),
                          .calls = total.calls};
}

}  // namespace stillpoint
