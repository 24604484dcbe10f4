// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/chi_square.h"

#include <cmath>

namespace stillpoint {

double chi_square_tail(double x, int degrees_of_freedom) {
  const double z = x / 2.0;
  const bool odd = degrees_of_freedom % 2 != 0;
  double a = odd ? 0.5 : 1.0;
  double tail = odd ? std::erfc(std::sqrt(z)) : std::exp(-z);
  double term = std::pow(z, a) * std::exp(-z) / std::tgamma(a + 1.0);
  for (; 2.0 * a < degrees_of_freedom; a += 1.0) {
    tail += term;
    term *= z / (a + 1.0);
  }
  return tail;
}

}  // namespace stillpoint
