// SPDX-License-Identifier: BSD-3-Clause
/// Which definitions yield a published number: all protocols with each alignment, relative errors over usual
/// intervals, and each statistic of the errors.
#pragma once

#include <string>
#include <vector>

#include "core/types/trajectory.h"

namespace stillpoint::eval {

/// A number as it was printed: its last digit is rounded.
struct PublishedNumber {
  double value = 0.0;
  double half_digit = 0.0;  ///< half of the unit of the last digit
};

/// @param text a decimal number > 0, e.g. "0.0150", whose last digit is 1e-4, or "1.5e-2"
/// @throws InputError if it is none
[[nodiscard]] PublishedNumber parse_published(const std::string& text);

/// A number that a definition yields.
struct DefinedNumber {
  std::string metric;    ///< "ATE rmse m", "RPE over 1 s, mean deg"
  std::string protocol;  ///< "compat:tum"
  std::string options;  ///< as for `stillpoint eval`: "--align sim3 --rpe-delta 1 --rpe-unit m"; may be empty
  double value = 0.0;
  std::size_t pairs = 0;  ///< of poses, or of relative motions
  bool agrees = false;    ///< it rounds to the published number, within 1e-9 of the value
};

/// All definitions that can be applied, those that agree first, then by their distance to the number. Of
/// several with the same metric, value and number of pairs, only the first is listed.
/// @param gt of the body frame of the estimate
/// @param est which the publication evaluates
/// @param number as published
[[nodiscard]] std::vector<DefinedNumber> search_protocols(const Trajectory& gt, const Trajectory& est,
                                                          const PublishedNumber& number);

}  // namespace stillpoint::eval
