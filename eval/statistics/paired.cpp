// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/paired.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stillpoint::eval {
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
