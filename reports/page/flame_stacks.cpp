// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/flame_stacks.h"

#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint {

void add_stacks(StackTimes& times, std::string_view folded, const std::string& place) {
  LineReader lines(folded);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (line->empty()) continue;
    const std::size_t space = line->rfind(' ');
    const std::optional<double> ns =
        space == std::string_view::npos ? std::nullopt : parse_number(line->substr(space + 1));
    if (!ns || space == 0)
      throw InputError(place, lines.line_number(), "is no folded stack; write \"outer;inner nanoseconds\"");
    times[std::string(line->substr(0, space))] += *ns;
  }
}

}  // namespace stillpoint
