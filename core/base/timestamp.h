// SPDX-License-Identifier: BSD-3-Clause
/// Points in time as whole nanoseconds, so that equal stamps compare equal.
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>

namespace stillpoint {

/// Nanoseconds since the data set's own epoch.
struct Timestamp {
  std::int64_t ns = 0;

  friend constexpr auto operator<=>(Timestamp, Timestamp) = default;
};

/// Signed span from `from` to `to` [s]. Files may hold stamps whose difference is beyond 64 bits.
[[nodiscard]] constexpr double seconds_between(Timestamp from, Timestamp to) {
  return static_cast<double>(static_cast<__int128>(to.ns) - from.ns) * 1e-9;
}

/// The stamp `seconds` after `t`, rounded to the nearest nanosecond.
[[nodiscard]] inline Timestamp after(Timestamp t, double seconds) {
  return Timestamp{t.ns + std::llround(seconds * 1e9)};
}

/// Seconds since the epoch [s]; exact to about 0.2 us for present-day Unix stamps: for printing and plots
/// only.
[[nodiscard]] constexpr double to_seconds(Timestamp t) { return static_cast<double>(t.ns) * 1e-9; }

/// The stamp of `seconds` since the epoch, rounded to the nearest nanosecond.
[[nodiscard]] inline Timestamp from_seconds(double seconds) { return Timestamp{std::llround(seconds * 1e9)}; }

}  // namespace stillpoint
