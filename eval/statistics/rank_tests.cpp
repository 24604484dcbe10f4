// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/rank_tests.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "eval/metrics/statistics.h"
#include "eval/statistics/modes.h"

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

std::optional<Interval> median_interval(std::span<const double> values, double confidence) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::vector<std::size_t> ranks(sorted.size(), 1);
  return interval_of_candidates(sorted, sign_distribution(ranks), confidence);
}

std::optional<Spread> spread(std::span<const double> values, double confidence) {
  if (values.empty()) return std::nullopt;
  return Spread{.count = values.size(),
                .median = *percentile(values, 0.5),
                .quartiles = {.low = *percentile(values, 0.25), .high = *percentile(values, 0.75)},
                .worst = *std::max_element(values.begin(), values.end()),
                .median_interval = median_interval(values, confidence),
                .modes = mode_count(values)};
}

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

namespace {

bool excludes_zero(const std::optional<Interval>& interval) {
  return interval && (interval->low > 0.0 || interval->high < 0.0);
}

bool is_usable(const Pair& pair) { return pair.base != 0.0 || pair.changed == 0.0; }

bool has_logarithm(const Pair& pair) {
  return (pair.base > 0.0 && pair.changed > 0.0) || (pair.base == 0.0 && pair.changed == 0.0);
}

/// x_i of a usable pair.
double change_of(const Pair& pair, bool logarithmic) {
  if (pair.base == pair.changed) return 0.0;
  return logarithmic ? std::log(pair.changed / pair.base) : (pair.changed - pair.base) / std::abs(pair.base);
}

}  // namespace

std::optional<PairedDifference> paired_difference(std::span<const Pair> pairs, double confidence) {
  std::vector<double> differences;
  for (const Pair& pair : pairs) differences.push_back(pair.changed - pair.base);
  const std::optional<SignedRank> test = signed_rank(differences, confidence);
  if (!test) return std::nullopt;
  return PairedDifference{.count = test->count,
                          .median = test->estimate,
                          .p_value = test->p_value,
                          .interval = test->interval,
                          .effect = rank_biserial(differences)};
}

std::optional<RelativeChange> relative_change(std::span<const Pair> pairs, double confidence) {
  std::vector<Pair> usable(pairs.begin(), pairs.end());
  std::erase_if(usable, [](const Pair& pair) { return !is_usable(pair); });
  const bool logarithmic = std::all_of(usable.begin(), usable.end(), has_logarithm);
  std::vector<double> changes;
  changes.reserve(usable.size());
  for (const Pair& pair : usable) changes.push_back(change_of(pair, logarithmic));
  const std::optional<SignedRank> test = signed_rank(changes, confidence);
  if (!test) return std::nullopt;
  RelativeChange change{
      .count = test->count, .median = test->estimate, .p_value = test->p_value, .interval = test->interval};
  if (!logarithmic) return change;
  change.median = std::expm1(change.median);
  if (change.interval)
    change.interval = {.low = std::expm1(test->interval->low), .high = std::expm1(test->interval->high)};
  return change;
}

bool is_significant(const PairedDifference& difference) { return excludes_zero(difference.interval); }

bool is_significant(const RelativeChange& change) { return excludes_zero(change.interval); }

}  // namespace stillpoint::eval
