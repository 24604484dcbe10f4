// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/profile_drift.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"

namespace stillpoint::bench {

double parse_duration_s(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  const double unit_s = unit == "s" ? 1.0 : unit == "m" ? 60.0 : unit == "h" ? 3600.0 : 0.0;
  constexpr double kLongestS = 1e6;
  const double seconds = value * unit_s;
  if (error != std::errc{} || !(seconds > 0.0) || seconds > kLongestS)
    throw InputError("--duration", "\"" + std::string(text) + "\" is not a duration; write 90s, 10m or 1h");
  return seconds;
}

nlohmann::ordered_json drift_json(const std::vector<DriftRow>& rows) {
  using Json = nlohmann::ordered_json;
  Json list = Json::array();
  for (const DriftRow& row : rows) {
    list.push_back({{"t_s", row.t_s},
                    {"frame_ms", row.frame_ms},
                    {"temperature_c", row.temperature_c ? Json(*row.temperature_c) : Json(nullptr)},
                    {"throttled", row.throttled ? Json(*row.throttled) : Json(nullptr)}});
  }
  return list;
}

std::string drift_text(const std::vector<DriftRow>& rows) {
  if (rows.empty()) return "";
  const DriftRow& first = rows.front();
  const DriftRow& last = rows.back();
  const auto celsius = [](const DriftRow& row) {
    return row.temperature_c ? fmt::format("{:.1f} deg C", *row.temperature_c) : "n/a";
  };
  const auto throttled = std::ranges::count(rows, std::optional(true), &DriftRow::throttled);
  const bool is_known =
      std::ranges::any_of(rows, [](const DriftRow& row) { return row.throttled.has_value(); });
  return fmt::format(
      "drift over {} repetitions in {:.0f} s: {:.3f} -> {:.3f} ms per frame, temperature {} -> {}, throttled "
      "in {}\n",
      rows.size(), last.t_s, first.frame_ms, last.frame_ms, celsius(first), celsius(last),
      is_known ? fmt::format("{}", throttled) : "n/a");
}

}  // namespace stillpoint::bench
