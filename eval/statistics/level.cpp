// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/level.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "eval/metrics/statistics.h"
#include "eval/statistics/rank_sum.h"

namespace stillpoint::eval {
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

/// y_i - slope i.
/// @param first index of the first value
std::vector<double> without_slope(std::span<const double> values, double slope, std::size_t first) {
  std::vector<double> flat;
  for (std::size_t i = 0; i < values.size(); ++i)
    flat.push_back(values[i] - slope * static_cast<double>(first + i));
  return flat;
}

/// Two levels of values without their common slope.
struct TwoLevels {
  double step = 0.0;
  double residuals = 0.0;
};

TwoLevels two_levels(std::span<const double> before, std::span<const double> after, double slope) {
  const std::vector<double> flat_before = without_slope(before, slope, 0);
  const std::vector<double> flat_after = without_slope(after, slope, before.size());
  return {.step = *percentile(flat_after, 0.5) - *percentile(flat_before, 0.5),
          .residuals = residuals_to_median(flat_before) + residuals_to_median(flat_after)};
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
  trend.intercept = *percentile(without_slope(values, trend.slope, 0), 0.5);
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
  constexpr std::size_t kMinWindow = 10;
  const double level_step = *percentile(after, 0.5) - *percentile(before, 0.5);
  const std::size_t window = std::max(kMinWindow, std::min(before.size(), after.size()));
  before = before.last(std::min(window, before.size()));
  after = after.first(std::min(window, after.size()));
  std::vector<double> values(before.begin(), before.end());
  values.insert(values.end(), after.begin(), after.end());
  const std::optional<Trend> line = trend_of(values);
  if (!line) return level_step;
  std::vector<double> slopes = pairwise_slopes(before);
  const std::vector<double> slopes_after = pairwise_slopes(after);
  slopes.insert(slopes.end(), slopes_after.begin(), slopes_after.end());
  const TwoLevels sloped = two_levels(before, after, percentile(slopes, 0.5).value_or(0.0));
  const double line_criterion =
      bayesian_information_criterion(residuals_to_line(values, *line), values.size(), 2);
  const double step_criterion =
      bayesian_information_criterion(two_levels(before, after, 0.0).residuals, values.size(), 3);
  const double sloped_criterion = bayesian_information_criterion(sloped.residuals, values.size(), 4);
  if (step_criterion <= std::min(line_criterion, sloped_criterion)) return level_step;
  return line_criterion <= sloped_criterion ? 0.0 : sloped.step;
}

}  // namespace stillpoint::eval
