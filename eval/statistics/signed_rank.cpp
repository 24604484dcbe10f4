// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/signed_rank.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "eval/metrics/statistics.h"

namespace stillpoint::eval {
namespace {

/// Twice the ranks, which are integers also for ties.
struct DoubledRanks {
  std::vector<std::size_t> all;
  std::size_t positive = 0;  ///< 2 T+
  std::size_t negative = 0;  ///< 2 T-
};

DoubledRanks doubled_ranks(std::span<const double> values) {
  std::vector<double> differences(values.begin(), values.end());
  std::erase(differences, 0.0);
  std::sort(differences.begin(), differences.end(),
            [](double a, double b) { return std::abs(a) < std::abs(b); });
  DoubledRanks ranks;
  for (std::size_t first = 0; first < differences.size();) {
    std::size_t last = first;
    while (last < differences.size() && std::abs(differences[last]) == std::abs(differences[first])) ++last;
    const std::size_t rank = first + 1 + last;  // twice the mean of first + 1 ... last
    for (; first < last; ++first) {
      ranks.all.push_back(rank);
      (differences[first] > 0.0 ? ranks.positive : ranks.negative) += rank;
    }
  }
  return ranks;
}

/// w_ij, ascending.
std::vector<double> sorted_pair_means(std::span<const double> differences) {
  std::vector<double> means;
  means.reserve(differences.size() * (differences.size() + 1) / 2);
  for (std::size_t i = 0; i < differences.size(); ++i) {
    for (std::size_t j = i; j < differences.size(); ++j)
      means.push_back(0.5 * differences[i] + 0.5 * differences[j]);
  }
  std::sort(means.begin(), means.end());
  return means;
}

}  // namespace

double smallest_p(std::size_t n) { return std::min(1.0, std::exp2(1.0 - static_cast<double>(n))); }

std::size_t smallest_count(double significance) {
  std::size_t n = 1;
  while (smallest_p(n) > significance) ++n;
  return n;
}

std::optional<SignedRank> signed_rank(std::span<const double> differences, double confidence) {
  if (differences.empty()) return std::nullopt;
  const DoubledRanks ranks = doubled_ranks(differences);
  const std::vector<double> means = sorted_pair_means(differences);
  std::vector<std::size_t> untied(differences.size());
  std::iota(untied.begin(), untied.end(), 1);
  return SignedRank{
      .count = differences.size(),
      .estimate = *percentile(means, 0.5),
      .p_value = two_sided_p(sign_distribution(ranks.all), std::min(ranks.positive, ranks.negative)),
      .interval = interval_of_candidates(means, sign_distribution(untied), confidence)};
}

double rank_biserial(std::span<const double> differences) {
  const DoubledRanks ranks = doubled_ranks(differences);
  if (ranks.all.empty()) return 0.0;
  const auto positive = static_cast<double>(ranks.positive);
  const auto negative = static_cast<double>(ranks.negative);
  return (positive - negative) / (positive + negative);
}

}  // namespace stillpoint::eval
