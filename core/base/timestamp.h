// SPDX-License-Identifier: BSD-3-Clause
/// Timestamps in integer nanoseconds, so that equal stamps compare equal.
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>

namespace stillpoint {

/// Nanoseconds since the epoch of the dataset.
struct Timestamp {
  std::int64_t ns = 0;

  friend constexpr auto operator<=>(Timestamp, Timestamp) = default;
};

/// Signed duration from `from` to `to` [s]. The difference of two valid stamps may exceed 64 bits.
[[nodiscard]] constexpr double seconds_between(Timestamp from, Timestamp to) {
  return static_cast<double>(static_cast<__int128>(to.ns) - from.ns) * 1e-9;
}

/// The stamp `seconds` after `t`, rounded to the nearest nanosecond.
[[nodiscard]] inline Timestamp after(Timestamp t, double seconds) {
  return Timestamp{t.ns + std::llround(seconds * 1e9)};
}

/// Seconds since the epoch [s], for printing and plots only: exact to about 0.2 us for current Unix stamps.
[[nodiscard]] constexpr double to_seconds(Timestamp t) { return static_cast<double>(t.ns) * 1e-9; }

/// The stamp of `seconds` since the epoch, rounded to the nearest nanosecond.
[[nodiscard]] inline Timestamp from_seconds(double seconds) { return Timestamp{std::llround(seconds * 1e9)}; }

}  // namespace stillpoint
