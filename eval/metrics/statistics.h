// SPDX-License-Identifier: BSD-3-Clause
/// Summary statistics of a list of errors, with the definitions of the TUM tools and evo.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace stillpoint::eval {

/// Percentiles that `Statistics` has, above the median and rising.
inline constexpr std::array<int, 4> kPercentiles{75, 90, 95, 99};

/// In the unit of the values; `sse` in its square.
struct Statistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;  ///< mean of the two middle values if the count is even
  double std = 0.0;     ///< of the population: sqrt(1/n sum (x - mean)^2)
  double min = 0.0;
  double max = 0.0;
  double sse = 0.0;                                       ///< sum of squares
  std::array<double, kPercentiles.size()> percentiles{};  ///< those of `kPercentiles`, see `percentile`
};

/// @return nullopt for an empty list, which is reported as "n/a", never as 0
[[nodiscard]] std::optional<Statistics> statistics(std::span<const double> values);

/// Percentile with linear interpolation between the closest ranks (NumPy's default).
/// @param values in any order
/// @param fraction in [0, 1]
/// @return nullopt for an empty list
[[nodiscard]] std::optional<double> percentile(std::span<const double> values, double fraction);

}  // namespace stillpoint::eval
