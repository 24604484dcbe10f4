// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/change_points.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "eval/metrics/statistics.h"

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

namespace {

bool all_positive(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return value > 0.0; });
}

std::vector<double> logarithms(std::span<const double> values) {
  std::vector<double> result;
  for (const double value : values) result.push_back(std::log(value));
  return result;
}

/// The change of the test's shift by a monotone function.
template <typename Function>
RelativeChange mapped(const RankSum& test, std::size_t count, const Function& map) {
  RelativeChange change{
      .count = count, .median = map(test.shift), .p_value = test.p_value, .interval = std::nullopt};
  if (test.interval) change.interval = {.low = map(test.interval->low), .high = map(test.interval->high)};
  return change;
}

/// Var(S) of the Mann-Kendall test: Kendall, Rank Correlation Methods, 1975, chapter 4.
double mann_kendall_variance(std::span<const double> values) {
  const auto weight = [](double n) { return n * (n - 1.0) * (2.0 * n + 5.0); };
  std::map<double, std::size_t> ties;
  for (const double value : values) ++ties[value];
  double sum = weight(static_cast<double>(values.size()));
  for (const auto& [value, count] : ties) sum -= weight(static_cast<double>(count));
  return sum / 18.0;
}

/// @param residuals sum of |r_i|; may be 0
double bayesian_information_criterion(double residuals, std::size_t values, std::size_t parameters) {
  const auto n = static_cast<double>(values);
  const double scale = std::max(residuals / n, 1e-300);
  return 2.0 * n * std::log(scale) + static_cast<double>(parameters) * std::log(n);
}

double residuals_to_median(std::span<const double> values) {
  const double median = percentile(values, 0.5).value_or(0.0);
  double sum = 0.0;
  for (const double value : values) sum += std::abs(value - median);
  return sum;
}

double residuals_to_line(std::span<const double> values, const Trend& line) {
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i)
    sum += std::abs(values[i] - line.intercept - line.slope * static_cast<double>(i));
  return sum;
}

/// Slopes between all values.
std::vector<double> pairwise_slopes(std::span<const double> values) {
  std::vector<double> slopes;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t k = i + 1; k < values.size(); ++k)
      slopes.push_back((values[k] - values[i]) / static_cast<double>(k - i));
  }
  return slopes;
}

/// y_i - slope (first + i).
std::vector<double> without_slope(std::span<const double> values, double slope, double first) {
  std::vector<double> flat;
  for (std::size_t i = 0; i < values.size(); ++i)
    flat.push_back(values[i] - slope * (first + static_cast<double>(i)));
  return flat;
}

/// Two adjacent segments.
struct Segments {
  std::span<const double> before;
  std::span<const double> after;

  [[nodiscard]] std::vector<double> values() const {
    std::vector<double> all(before.begin(), before.end());
    all.insert(all.end(), after.begin(), after.end());
    return all;
  }
  /// The nearest `count` values on each side of the boundary.
  [[nodiscard]] Segments near(std::size_t count) const {
    return {before.last(std::min(count, before.size())), after.first(std::min(count, after.size()))};
  }
  /// Median slope within the segments; 0 if each has one value.
  [[nodiscard]] double common_slope() const {
    std::vector<double> slopes = pairwise_slopes(before);
    const std::vector<double> slopes_after = pairwise_slopes(after);
    slopes.insert(slopes.end(), slopes_after.begin(), slopes_after.end());
    return percentile(slopes, 0.5).value_or(0.0);
  }
};

/// Levels of both segments at the boundary.
struct TwoLevels {
  double step = 0.0;
  double residuals = 0.0;  ///< sum of |r_i|
};

/// @param slope_before, slope_after trends that are removed
TwoLevels two_levels(const Segments& segments, double slope_before, double slope_after) {
  // Index 0 at the boundary, between the last value before and the first one after it.
  const double first = 0.5 - static_cast<double>(segments.before.size());
  const std::vector<double> before = without_slope(segments.before, slope_before, first);
  const std::vector<double> after = without_slope(segments.after, slope_after, 0.5);
  return {.step = *percentile(after, 0.5) - *percentile(before, 0.5),
          .residuals = residuals_to_median(before) + residuals_to_median(after)};
}

/// Whether a line explains the values better than a step with or without a trend, see `step_beside_trend`.
bool is_line(const Segments& segments) {
  const std::vector<double> values = segments.values();
  const std::optional<Trend> line = trend_of(values);
  if (!line) return false;
  const double slope = segments.common_slope();
  const auto criterion = [&](double residuals, std::size_t parameters) {
    return bayesian_information_criterion(residuals, values.size(), parameters);
  };
  return criterion(residuals_to_line(values, *line), 2) <
         std::min(criterion(two_levels(segments, 0.0, 0.0).residuals, 6),
                  criterion(two_levels(segments, slope, slope).residuals, 8));
}

}  // namespace

std::optional<RelativeChange> level_change(std::span<const double> before, std::span<const double> after,
                                           double confidence) {
  if (before.empty() || after.empty()) return std::nullopt;
  const std::size_t count = std::min(before.size(), after.size());
  if (all_positive(before) && all_positive(after)) {
    const RankSum test = *rank_sum(logarithms(before), logarithms(after), confidence);
    return mapped(test, count, [](double x) { return std::expm1(x); });
  }
  const double level = std::abs(*percentile(before, 0.5));
  if (level == 0.0 && *percentile(after, 0.5) != 0.0) return std::nullopt;
  if (level == 0.0) return RelativeChange{.count = count};
  return mapped(*rank_sum(before, after, confidence), count, [&](double shift) { return shift / level; });
}

std::optional<Trend> trend_of(std::span<const double> values) {
  constexpr std::size_t kMinValues = 4;
  if (values.size() < kMinValues) return std::nullopt;
  double signs = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t k = i + 1; k < values.size(); ++k) {
      const double rise = values[k] - values[i];
      signs += rise > 0.0 ? 1.0 : (rise < 0.0 ? -1.0 : 0.0);
    }
  }
  Trend trend{.slope = *percentile(pairwise_slopes(values), 0.5), .intercept = 0.0, .p_value = 1.0};
  trend.intercept = *percentile(without_slope(values, trend.slope, 0.0), 0.5);
  const double variance = mann_kendall_variance(values);
  const double corrected = std::max(std::abs(signs) - 1.0, 0.0);  // for continuity
  if (variance > 0.0) trend.p_value = std::erfc(corrected / std::sqrt(2.0 * variance));
  return trend;
}

bool linear_trend_fits_better(std::span<const double> values, const Trend& trend,
                              const std::vector<std::size_t>& changes) {
  double to_levels = 0.0;
  std::size_t first = 0;
  for (const std::size_t change : changes) {
    to_levels += residuals_to_median(values.subspan(first, change - first));
    first = change;
  }
  to_levels += residuals_to_median(values.subspan(first));
  return bayesian_information_criterion(residuals_to_line(values, trend), values.size(), 2) <
         bayesian_information_criterion(to_levels, values.size(), 2 * changes.size() + 1);
}

double step_beside_trend(std::span<const double> before, std::span<const double> after) {
  constexpr std::size_t kNear = 20;
  constexpr std::size_t kMinForSlope = 7;  // with fewer values the slope of a segment says little
  const Segments whole{before, after};
  const Segments near = whole.near(kNear);
  if (is_line(near)) return 0.0;
  std::vector<double> steps = {two_levels(whole, 0.0, 0.0).step};
  for (const Segments& segments : {whole, near}) {
    const double slope = segments.common_slope();
    steps.push_back(two_levels(segments, slope, slope).step);
  }
  if (std::min(near.before.size(), near.after.size()) >= kMinForSlope) {
    const Segments only_before{near.before, {}};
    const Segments only_after{near.after, {}};
    steps.push_back(two_levels(near, only_before.common_slope(), only_after.common_slope()).step);
  }
  const auto [low, high] = std::minmax_element(steps.begin(), steps.end());
  if (*low < 0.0 && *high > 0.0) return 0.0;
  return *low >= 0.0 ? *low : *high;
}

}  // namespace stillpoint::eval
