// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/level.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "eval/metrics/statistics.h"
#include "eval/statistics/random_index.h"

namespace stillpoint::eval {
namespace {

std::optional<double> ratio_change(double before, double after) {
  if (before == 0.0) return after == 0.0 ? std::optional(0.0) : std::nullopt;
  return (after - before) / std::abs(before);
}

double resampled_median(std::span<const double> values, std::vector<double>& sample,
                        std::mt19937_64& random) {
  sample.resize(values.size());
  std::generate(sample.begin(), sample.end(), [&] { return values[random_index(random, values.size())]; });
  return *percentile(sample, 0.5);
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

}  // namespace

std::optional<RelativeChange> level_change(std::span<const double> before, std::span<const double> after,
                                           const BootstrapOptions& options) {
  if (before.empty() || after.empty()) return std::nullopt;
  const std::optional<double> change = ratio_change(*percentile(before, 0.5), *percentile(after, 0.5));
  if (!change) return std::nullopt;
  std::mt19937_64 random(options.seed);
  std::vector<double> sample;
  std::vector<double> changes;
  for (std::size_t i = 0; i < options.resamples; ++i) {
    const double first = resampled_median(before, sample, random);
    const double second = resampled_median(after, sample, random);
    if (const std::optional<double> drawn = ratio_change(first, second)) changes.push_back(*drawn);
  }
  if (changes.empty()) changes.push_back(*change);
  const double tail = 0.5 * (1.0 - options.confidence);
  return RelativeChange{.count = std::min(before.size(), after.size()),
                        .median = *change,
                        .interval = {*percentile(changes, tail), *percentile(changes, 1.0 - tail)}};
}

std::optional<Trend> trend_of(std::span<const double> values) {
  constexpr std::size_t kMinValues = 4;
  if (values.size() < kMinValues) return std::nullopt;
  std::vector<double> slopes;
  double signs = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t k = i + 1; k < values.size(); ++k) {
      const double rise = values[k] - values[i];
      slopes.push_back(rise / static_cast<double>(k - i));
      signs += rise > 0.0 ? 1.0 : (rise < 0.0 ? -1.0 : 0.0);
    }
  }
  Trend trend{.slope = *percentile(slopes, 0.5), .intercept = 0.0, .p_value = 1.0};
  std::vector<double> intercepts;
  for (std::size_t i = 0; i < values.size(); ++i)
    intercepts.push_back(values[i] - trend.slope * static_cast<double>(i));
  trend.intercept = *percentile(intercepts, 0.5);
  const double variance = mann_kendall_variance(values);
  const double corrected = std::max(std::abs(signs) - 1.0, 0.0);  // for continuity
  if (variance > 0.0) trend.p_value = std::erfc(corrected / std::sqrt(2.0 * variance));
  return trend;
}

bool linear_trend_fits_better(std::span<const double> values, const Trend& trend,
                              const std::vector<std::size_t>& changes) {
  double to_line = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i)
    to_line += std::abs(values[i] - trend.intercept - trend.slope * static_cast<double>(i));
  double to_levels = 0.0;
  std::size_t first = 0;
  for (const std::size_t change : changes) {
    to_levels += residuals_to_median(values.subspan(first, change - first));
    first = change;
  }
  to_levels += residuals_to_median(values.subspan(first));
  return bayesian_information_criterion(to_line, values.size(), 2) <
         bayesian_information_criterion(to_levels, values.size(), 2 * changes.size() + 1);
}

}  // namespace stillpoint::eval
