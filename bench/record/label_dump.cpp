// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/label_dump.h"

#include <fmt/format.h>

#include <iterator>

namespace stillpoint::bench {

void LabelDump::add(const FrameReport& report) {
  const std::int64_t ns = report.tracked.t.ns;
  const std::string stamp = fmt::format("{}.{:09}", ns / 1'000'000'000, ns % 1'000'000'000);
  auto label = report.dynamic.labels.begin();
  for (const TrackedFeature& feature : report.tracked.features) {
    if (label == report.dynamic.labels.end() || label->id != feature.id) continue;
    fmt::format_to(std::back_inserter(text_), "{},{},{},{:.2f},{:.2f},{:.3f},{},{},{},{}\n",
                   report.tracked.id, stamp, feature.id, feature.pixel.x(), feature.pixel.y(), feature.depth,
                   feature.age, label_name(label->label), reason_name(label->reason),
                   label->residual_px ? fmt::format("{:.3f}", *label->residual_px) : "");
    ++label;
  }
}

}  // namespace stillpoint::bench
