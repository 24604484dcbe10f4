// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/paired.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "eval/metrics/statistics.h"

namespace stillpoint::eval {
namespace {

double rank_biserial(std::vector<double> differences) {
  std::erase(differences, 0.0);
  std::sort(differences.begin(), differences.end(),
            [](double a, double b) { return std::abs(a) < std::abs(b); });
  double balance = 0.0;
  double total = 0.0;
  for (std::size_t first = 0; first < differences.size();) {
    std::size_t last = first;
    while (last < differences.size() && std::abs(differences[last]) == std::abs(differences[first])) ++last;
    const double rank = 0.5 * static_cast<double>(first + 1 + last);  // mean of first + 1 ... last
    for (; first < last; ++first) {
      balance += differences[first] > 0.0 ? rank : -rank;
      total += rank;
    }
  }
  return total > 0.0 ? balance / total : 0.0;
}

}  // namespace

std::optional<PairedDifference> paired_difference(std::span<const Pair> pairs,
                                                  const BootstrapOptions& options) {
  std::vector<double> differences;
  for (const Pair& pair : pairs) differences.push_back(pair.changed - pair.base);
  const std::optional<Interval> interval = median_interval(differences, options);
  if (!interval) return std::nullopt;
  return PairedDifference{.count = pairs.size(),
                          .median = *percentile(differences, 0.5),
                          .interval = *interval,
                          .effect = rank_biserial(differences)};
}

std::optional<RelativeChange> relative_change(std::span<const Pair> pairs, const BootstrapOptions& options) {
  std::vector<double> changes;
  for (const Pair& pair : pairs) {
    if (pair.base == 0.0 && pair.changed != 0.0) continue;
    changes.push_back(pair.base == 0.0 ? 0.0 : pair.changed / pair.base - 1.0);
  }
  const std::optional<Interval> interval = median_interval(changes, options);
  if (!interval) return std::nullopt;
  return RelativeChange{.count = changes.size(), .median = *percentile(changes, 0.5), .interval = *interval};
}

}  // namespace stillpoint::eval
