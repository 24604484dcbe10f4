// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/charts/flame_stacks.h"

#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::report {

StackTimes parse_stacks(std::string_view folded, const std::string& source) {
  StackTimes times;
  eval::LineReader lines(folded);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (line->empty()) continue;
    const std::size_t space = line->rfind(' ');
    const std::optional<double> ns =
        space == std::string_view::npos ? std::nullopt : eval::parse_number(line->substr(space + 1));
    if (!ns || space == 0)
      throw InputError(source, lines.line_number(),
                       "is not a folded stack; expected \"outer;inner nanoseconds\"");
    times[std::string(line->substr(0, space))] += *ns;
  }
  return times;
}

}  // namespace stillpoint::report
