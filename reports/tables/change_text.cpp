// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/change_text.h"

#include <fmt/format.h>

namespace stillpoint::report {

std::string percent_text(double ratio) { return fmt::format("{:+.1f} %", 100.0 * ratio); }

std::string interval_text(const eval::RelativeChange& change) {
  if (!change.interval) return fmt::format("n = {}, no interval", change.count);
  return fmt::format("n = {}, {:+.1f} to {}", change.count, 100.0 * change.interval->low,
                     percent_text(change.interval->high));
}

}  // namespace stillpoint::report
