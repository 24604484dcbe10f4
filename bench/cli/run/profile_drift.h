// SPDX-License-Identifier: BSD-3-Clause
/// Drift of times and temperature while one run is repeated: `stillpoint profile --duration`.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace stillpoint::bench {

/// One repetition of the run.
struct DriftRow {
  double t_s = 0.0;       ///< end of the repetition, since the start of the first
  double frame_ms = 0.0;  ///< mean time of all stages per frame
  std::optional<double> temperature_c{};
  std::optional<bool> throttled{};  ///< during the repetition
};

/// "90s", "10m" or "1h", with an optional fraction [s].
/// @throws InputError unless the text is a positive number with one of these units
[[nodiscard]] double parse_duration_s(std::string_view text);

/// Null for values that are not available.
[[nodiscard]] nlohmann::ordered_json drift_json(const std::vector<DriftRow>& rows);

/// The change from the first to the last repetition, "n/a" for values that are not available; empty without
/// rows.
[[nodiscard]] std::string drift_text(const std::vector<DriftRow>& rows);

}  // namespace stillpoint::bench
