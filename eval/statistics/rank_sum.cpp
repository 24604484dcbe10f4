// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/rank_sum.h"

#include <algorithm>
#include <vector>

#include "eval/metrics/statistics.h"

namespace stillpoint::eval {

std::optional<RankSum> rank_sum(std::span<const double> before, std::span<const double> after,
                                double confidence) {
  if (before.empty() || after.empty()) return std::nullopt;
  std::vector<double> differences;
  differences.reserve(before.size() * after.size());
  for (const double first : before) {
    for (const double second : after) differences.push_back(second - first);
  }
  std::sort(differences.begin(), differences.end());
  const auto count_below =
      std::lower_bound(differences.begin(), differences.end(), 0.0) - differences.begin();
  const auto count_above = differences.end() - std::upper_bound(differences.begin(), differences.end(), 0.0);
  const std::size_t against =
      differences.size() - static_cast<std::size_t>(std::max(count_below, count_above));
  const std::vector<double> distribution = mann_whitney_distribution(before.size(), after.size());
  return RankSum{.shift = *percentile(differences, 0.5),
                 .p_value = two_sided_p(distribution, against),
                 .interval = interval_of_candidates(differences, distribution, confidence)};
}

}  // namespace stillpoint::eval
