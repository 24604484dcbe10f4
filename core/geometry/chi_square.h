// SPDX-License-Identifier: BSD-3-Clause
/// Tail of the chi-square distribution, for decisions by a squared Mahalanobis distance.
#pragma once

namespace stillpoint {

/// P(X > x) of the chi-square distribution. With Q(a, z) the regularized incomplete gamma function, this is
/// Q(n / 2, x / 2), by the recurrence
///
///   Q(1/2, z) = erfc(sqrt(z)),    Q(1, z) = exp(-z),    Q(a + 1, z) = Q(a, z) + z^a exp(-z) / Gamma(a + 1)
///
/// (Abramowitz and Stegun 1964, 6.5.21 and 26.4.4).
/// @param x >= 0
/// @param degrees_of_freedom n >= 1
[[nodiscard]] double chi_square_tail(double x, int degrees_of_freedom);

}  // namespace stillpoint
