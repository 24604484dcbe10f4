// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/rank_distribution.h"

#include <algorithm>

namespace stillpoint::eval {

std::vector<double> sign_distribution(std::span<const std::size_t> ranks) {
  std::vector<double> probabilities = {1.0};
  for (const std::size_t rank : ranks) {
    const std::size_t size = probabilities.size();
    probabilities.resize(size + rank, 0.0);
    for (std::size_t t = probabilities.size(); t-- > 0;) {
      const double negative = t < size ? probabilities[t] : 0.0;
      const double positive = t >= rank ? probabilities[t - rank] : 0.0;
      probabilities[t] = 0.5 * negative + 0.5 * positive;
    }
  }
  return probabilities;
}

std::vector<double> mann_whitney_distribution(std::size_t first, std::size_t second) {
  // Element m: P_(m,n), for the current n; starts with P_(m,0)(0) = 1.
  std::vector<std::vector<double>> row(first + 1, std::vector<double>{1.0});
  for (std::size_t n = 1; n <= second; ++n) {
    for (std::size_t m = 1; m <= first; ++m) {
      const double from_first = static_cast<double>(m) / static_cast<double>(m + n);
      std::vector<double> next(m * n + 1, 0.0);
      for (std::size_t u = 0; u < row[m - 1].size(); ++u) next[u] += from_first * row[m - 1][u];
      for (std::size_t u = 0; u < row[m].size(); ++u) next[u + m] += (1.0 - from_first) * row[m][u];
      row[m] = std::move(next);
    }
  }
  return row[first];
}

double two_sided_p(std::span<const double> distribution, std::size_t t) {
  double tail = 0.0;
  for (std::size_t i = 0; i <= t && i < distribution.size(); ++i) tail += distribution[i];
  return std::min(1.0, 2.0 * tail);
}

std::optional<Interval> interval_of_candidates(std::span<const double> sorted,
                                               std::span<const double> distribution, double confidence) {
  const double tail = 0.5 * (1.0 - confidence);
  std::size_t k = 0;
  double sum = 0.0;
  while (2 * k < sorted.size()) {
    sum += distribution[k];
    if (sum > tail) break;
    ++k;
  }
  if (k == 0) return std::nullopt;
  return Interval{.low = sorted[k - 1], .high = sorted[sorted.size() - k]};
}

}  // namespace stillpoint::eval
