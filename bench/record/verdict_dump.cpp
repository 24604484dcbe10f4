// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/verdict_dump.h"

#include <fmt/format.h>

#include <iterator>

namespace stillpoint {

void VerdictDump::add(const PictureReport& report) {
  const std::int64_t ns = report.tracked.t.ns;
  const std::string stamp = fmt::format("{}.{:09}", ns / 1'000'000'000, ns % 1'000'000'000);
  auto verdict = report.dynamic.verdicts.begin();
  for (const TrackedFeature& feature : report.tracked.features) {
    if (verdict == report.dynamic.verdicts.end() || verdict->id != feature.id) continue;
    fmt::format_to(std::back_inserter(text_), "{},{},{},{:.2f},{:.2f},{:.3f},{},{},{},{}\n",
                   report.tracked.id, stamp, feature.id, feature.pixel.x(), feature.pixel.y(), feature.depth,
                   feature.age, verdict_name(verdict->verdict), reason_name(verdict->reason),
                   verdict->residual_px ? fmt::format("{:.3f}", *verdict->residual_px) : "");
    ++verdict;
  }
}

}  // namespace stillpoint
