// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/timing_text.h"

#include <charconv>

#include <fmt/format.h>

#include "core/base/error.h"

namespace stillpoint {
namespace {

constexpr std::string_view kHeader = "frame,module,ns,calls";

/// Cuts the part before `separator` off the front of `text`.
std::string_view cut(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return part;
}

/// Takes one line apart; a struct for the sake of its place.
struct LineReader {
  const std::string& place;
  long line;

  [[nodiscard]] std::int64_t number(std::string_view text) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc{} && end == text.data() + text.size()) return value;
    throw InputError(place, line,
                     "\"" + std::string(text) + "\" is no whole number; write frame,module,ns,calls");
  }

  [[nodiscard]] TimingSample sample(std::string_view text) const {
    TimingSample sample;
    sample.frame = number(cut(text, ','));
    sample.module = std::string(cut(text, ','));
    sample.ns = number(cut(text, ','));
    sample.calls = number(text);
    return sample;
  }
};

}  // namespace

std::string timing_text(std::span<const TimingSample> samples) {
  std::string text = std::string(kHeader) + "\n";
  for (const TimingSample& sample : samples) {
    text += fmt::format("{},{},{},{}\n", sample.frame, sample.module, sample.ns, sample.calls);
  }
  return text;
}

std::vector<TimingSample> parse_timings(std::string_view text, const std::string& place) {
  std::vector<TimingSample> samples;
  long line = 1;
  if (cut(text, '\n') != kHeader)
    throw InputError(place, line, "does not begin with " + std::string(kHeader));
  while (!text.empty()) {
    const std::string_view row = cut(text, '\n');
    ++line;
    if (!row.empty()) samples.push_back(LineReader{place, line}.sample(row));
  }
  return samples;
}

}  // namespace stillpoint
