// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/number_range.h"

#include <optional>

#include <fmt/format.h>

#include "eval/io/text_reader.h"

namespace stillpoint::bench {

std::string range_problem(const std::string& value, const NumberRange& range) {
  const std::optional<double> number = eval::parse_number(value);
  if (!number || (*number >= range.least && *number <= range.most)) return "";
  return fmt::format("must be from {:g} to {:g}, not {}", range.least, range.most, value);
}

}  // namespace stillpoint::bench
