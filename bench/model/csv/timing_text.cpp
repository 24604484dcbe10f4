// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/csv/timing_text.h"

#include <fmt/format.h>

#include "bench/model/csv/csv_rows.h"

namespace stillpoint::bench {
namespace {

constexpr std::string_view kTimingHeader = "frame,module,ns,calls";

TimingSample sample_of(const CsvRows& rows, std::string_view text) {
  TimingSample sample;
  sample.frame = rows.number(cut_front(text, ','));
  sample.module = std::string(cut_front(text, ','));
  sample.ns = rows.number(cut_front(text, ','));
  sample.calls = rows.number(text);
  return sample;
}

}  // namespace

std::string timing_text(std::span<const TimingSample> samples) {
  std::string text = std::string(kTimingHeader) + "\n";
  for (const TimingSample& sample : samples) {
    text += fmt::format("{},{},{},{}\n", sample.frame, sample.module, sample.ns, sample.calls);
  }
  return text;
}

std::vector<TimingSample> parse_timings(std::string_view text, const std::string& place) {
  std::vector<TimingSample> samples;
  CsvRows rows{.place = place, .header = kTimingHeader};
  rows.for_each_row(text, [&](std::string_view row) { samples.push_back(sample_of(rows, row)); });
  return samples;
}

}  // namespace stillpoint::bench
