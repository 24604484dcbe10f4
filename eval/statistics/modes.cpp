// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/modes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace stillpoint::eval {
namespace {

constexpr std::size_t kMinGroup = 2;
constexpr double kMinFactor = 1.1;  // between groups; less is of no consequence

/// 95 % quantile of the largest G_k of `count` normal values.
struct Quantile {
  std::size_t count;
  double gap;
};
constexpr std::array<Quantile, 12> kQuantiles{{{5, 5.34},
                                               {6, 4.42},
                                               {7, 3.78},
                                               {8, 3.31},
                                               {9, 3.00},
                                               {10, 2.73},
                                               {12, 2.33},
                                               {15, 1.95},
                                               {20, 1.60},
                                               {30, 1.25},
                                               {40, 1.10},
                                               {80, 0.88}}};

/// That of the next smaller number of values in the table, which is larger.
double critical_gap(std::size_t count) {
  double gap = std::numeric_limits<double>::infinity();
  for (const Quantile& quantile : kQuantiles) {
    if (quantile.count <= count) gap = quantile.gap;
  }
  return gap;
}

double squared_deviations(std::span<const double> values) {
  double mean = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return sum;
}

/// @param sorted logarithms in ascending order
std::size_t modes_of(std::span<const double> sorted) {
  if (sorted.size() < kMinModeValues) return 1;
  double largest = 0.0;
  std::size_t split = 0;
  for (std::size_t k = kMinGroup; k + kMinGroup <= sorted.size(); ++k) {
    const double gap = sorted[k] - sorted[k - 1];
    if (gap < std::log(kMinFactor)) continue;
    const double within =
        std::sqrt((squared_deviations(sorted.first(k)) + squared_deviations(sorted.subspan(k))) /
                  static_cast<double>(sorted.size() - 2));
    const double ratio = within > 0.0 ? gap / within : std::numeric_limits<double>::infinity();
    if (ratio <= largest) continue;
    largest = ratio;
    split = k;
  }
  if (largest <= critical_gap(sorted.size())) return 1;
  return modes_of(sorted.first(split)) + modes_of(sorted.subspan(split));
}

}  // namespace

std::optional<std::size_t> mode_count(std::span<const double> values) {
  if (values.size() < kMinModeValues) return std::nullopt;
  std::vector<double> logarithms;
  logarithms.reserve(values.size());
  for (const double value : values) {
    if (value <= 0.0) return std::nullopt;
    logarithms.push_back(std::log(value));
  }
  std::sort(logarithms.begin(), logarithms.end());
  return modes_of(logarithms);
}

}  // namespace stillpoint::eval
