// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/change_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>

namespace stillpoint::eval {
namespace {

constexpr double kRounding = 1e-9;  // relative; sums of permuted values differ by rounding

/// Bisection of a segment into [0, index) and [index, k).
struct Split {
  std::size_t index = 0;
  double divergence = 0.0;  ///< Q
};

double pair_count(std::size_t values) {
  return 0.5 * static_cast<double>(values) * static_cast<double>(values - 1);
}

/// Element k: sum of |x_i - x_j| over all pairs of the first k values.
std::vector<double> leading_sums(std::span<const double> values) {
  std::vector<double> sums(values.size() + 1, 0.0);
  for (std::size_t k = 1; k <= values.size(); ++k) {
    double added = 0.0;
    for (std::size_t i = 0; i + 1 < k; ++i) added += std::abs(values[i] - values[k - 1]);
    sums[k] = sums[k - 1] + added;
  }
  return sums;
}

/// Maximum of Q over values [0, t) and [t, k), for all t and k.
Split best_split(std::span<const double> values, std::size_t min_segment) {
  const std::size_t n = values.size();
  Split best;
  if (n < 2 * min_segment) return best;
  const std::vector<double> leading = leading_sums(values);
  std::vector<double> to_later(n, 0.0);  // element j: sum of |x_i - x_j| for i in [t, j)
  for (std::size_t t = n; t-- > min_segment;) {
    for (std::size_t j = t + 1; j < n; ++j) to_later[j] += std::abs(values[t] - values[j]);
    double within = 0.0;  // sum over all pairs of values [t, k)
    for (std::size_t k = t + 1; k <= n; ++k) {
      within += to_later[k - 1];
      if (k < t + min_segment) continue;
      const auto first = static_cast<double>(t);
      const auto second = static_cast<double>(k - t);
      const double between = leading[k] - leading[t] - within;
      const double divergence =
          2.0 * between / (first * second) - leading[t] / pair_count(t) - within / pair_count(k - t);
      const double scaled = first * second / (first + second) * divergence;
      if (scaled > best.divergence) best = {t, scaled};
    }
  }
  return best;
}

/// The best split of all segments; its index refers to the whole series.
/// @param bounds index of the first value of each segment, and the number of values
Split best_of_segments(std::span<const double> values, const std::vector<std::size_t>& bounds,
                       std::size_t min_segment) {
  Split best;
  for (std::size_t i = 0; i + 1 < bounds.size(); ++i) {
    const Split split = best_split(values.subspan(bounds[i], bounds[i + 1] - bounds[i]), min_segment);
    if (split.divergence > best.divergence) best = {bounds[i] + split.index, split.divergence};
  }
  return best;
}

/// Uniform integer in [0, count), count > 0: floor(u * count / 2^64) with u from the generator. Unlike that
/// of std::uniform_int_distribution its sequence does not depend on the standard library.
std::size_t random_index(std::mt19937_64& random, std::size_t count) {
  return static_cast<std::size_t>((static_cast<unsigned __int128>(random()) * count) >> 64);
}

/// Fisher-Yates shuffle.
void shuffle(std::span<double> values, std::mt19937_64& random) {
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random_index(random, i)]);
}

/// p-value of the permutation test; ends early once it is certain to exceed `significance`.
double p_value(std::span<const double> values, const std::vector<std::size_t>& bounds, double divergence,
               const ChangePointOptions& options) {
  const auto tests = static_cast<double>(options.permutations + 1);
  std::vector<double> permuted(values.begin(), values.end());
  std::mt19937_64 random(options.seed);
  std::size_t reached = 1;  // counts the original order
  for (std::size_t done = 1; done <= options.permutations; ++done) {
    for (std::size_t i = 0; i + 1 < bounds.size(); ++i)
      shuffle(std::span(permuted).subspan(bounds[i], bounds[i + 1] - bounds[i]), random);
    const Split split = best_of_segments(permuted, bounds, options.min_segment);
    if (split.divergence >= divergence * (1.0 - kRounding)) ++reached;
    if (static_cast<double>(reached) > options.significance * tests)
      return static_cast<double>(reached) / static_cast<double>(done + 1);
  }
  return static_cast<double>(reached) / tests;
}

}  // namespace

std::vector<ChangePoint> change_points(std::span<const double> values, const ChangePointOptions& options) {
  std::vector<ChangePoint> changes;
  std::vector<std::size_t> bounds = {0, values.size()};
  while (true) {
    const Split split = best_of_segments(values, bounds, options.min_segment);
    if (split.divergence <= 0.0) break;
    const double p = p_value(values, bounds, split.divergence, options);
    if (p > options.significance) break;
    changes.push_back({split.index, p});
    bounds.insert(std::upper_bound(bounds.begin(), bounds.end(), split.index), split.index);
  }
  std::sort(changes.begin(), changes.end(),
            [](const ChangePoint& a, const ChangePoint& b) { return a.index < b.index; });
  return changes;
}

}  // namespace stillpoint::eval
