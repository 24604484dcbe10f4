// SPDX-License-Identifier: BSD-3-Clause
/// Summaries of a list of errors.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace stillpoint {

/// In the unit of the values; `sse` in its square.
struct Statistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;  ///< mean of the middle two for an even count
  double std = 0.0;     ///< of the population: divided by n
  double min = 0.0;
  double max = 0.0;
  double sse = 0.0;
};

/// Nothing for an empty list: no data is "n/a", never 0.
[[nodiscard]] std::optional<Statistics> statistics(std::span<const double> values);

/// Linear interpolation between the closest ranks (NumPy's default). `share` in [0, 1].
[[nodiscard]] std::optional<double> percentile(std::span<const double> values, double share);

}  // namespace stillpoint
