// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/counter_random.h"

#include <cmath>
#include <numbers>

namespace stillpoint::synth {
namespace {

/// Upper-tail probability of the standard normal distribution.
double normal_tail(double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2); }

/// Inverse of `normal_tail` by bisection; probability in (0, 0.5].
double normal_quantile(double probability) {
  double low = 0.0, high = 8.0;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (normal_tail(middle) > probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

std::array<float, kNormalQuantiles> make_quantiles() {
  std::array<float, kNormalQuantiles> table{};
  double sum_of_squares = 0.0;
  for (int i = 0; i < kNormalQuantiles / 2; ++i) {
    const double value = normal_quantile((i + 0.5) / kNormalQuantiles);
    table[static_cast<std::size_t>(i)] = static_cast<float>(-value);
    table[static_cast<std::size_t>(kNormalQuantiles - 1 - i)] = static_cast<float>(value);
    sum_of_squares += 2.0 * value * value;
  }
  const auto unit_variance = static_cast<float>(std::sqrt(kNormalQuantiles / sum_of_squares));
  for (float& value : table) value *= unit_variance;
  return table;
}

}  // namespace

const std::array<float, kNormalQuantiles>& normal_quantiles() {
  static const std::array<float, kNormalQuantiles> quantiles = make_quantiles();
  return quantiles;
}

float normal_from_bits(std::uint64_t bits) { return normal_quantiles()[bits & (kNormalQuantiles - 1)]; }

double RandomSequence::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

}  // namespace stillpoint::synth
