// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/heat_map.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "bench/compare/run_statistics.h"
#include "reports/tables/escaping.h"
#include "reports/tables/run_cells.h"

namespace stillpoint {
namespace {

std::string percent(double share) { return fmt::format("{:+.1f} %", 100.0 * share); }

/// Depth of colour [%]: full at a factor of two in either direction.
int depth(double change) {
  const double octaves = std::log2(std::max(1.0 + change, 1e-3));
  return static_cast<int>(std::lround(60.0 * std::min(std::abs(octaves), 1.0)));
}

/// One pair, or an interval that holds 0, proves nothing: such cells are hatched.
std::string cell_html(const AblationRow& row) {
  std::string lost = row.lost == 0 ? "" : fmt::format("<br>{} lost", row.lost);
  if (!row.change) return "<td class=\"empty\">-" + lost + "</td>";
  const RelativeChange& change = *row.change;
  const std::string interval =
      change.count == 1 ? "1 pair" : percent(change.interval.low) + " to " + percent(change.interval.high);
  const bool is_sure = change.count > 1 && (change.interval.low > 0.0 || change.interval.high < 0.0);
  return fmt::format(
      "<td class=\"{}{}\" style=\"--depth:{}%\" title=\"{} pairs\">{}<span class=\"interval\">{}"
      "</span>{}</td>",
      change.median > 0.0 ? "worse" : "better", is_sure ? "" : " unsure", depth(change.median), change.count,
      percent(change.median), interval, lost);
}

std::vector<StoredRun> comparable(std::span<const StoredRun> runs) {
  std::vector<StoredRun> kept(runs.begin(), runs.end());
  std::erase_if(kept, [](const StoredRun& run) {
    return run.identity.system != "stillpoint" || !run.identity.axis.empty();
  });
  return kept;
}

}  // namespace

std::string base_variant(std::span<const StoredRun> runs) {
  const std::vector<std::string> labels = distinct(runs, system_label);
  for (const char* name : {"dynamic_vins", "stillpoint", "vo"}) {
    if (std::find(labels.begin(), labels.end(), name) != labels.end()) return name;
  }
  return labels.empty() ? "" : labels.front();
}

std::string heat_map_html(std::span<const StoredRun> all, const std::string& base,
                          const std::string& metric) {
  const std::vector<StoredRun> runs = comparable(all);
  if (distinct(runs, system_label).size() < 2) return "";
  const std::vector<std::string> sequences =
      distinct(runs, [](const RunIdentity& identity) { return identity.sequence; });
  std::string text = fmt::format(
      "<div class=\"table\"><table class=\"heat\"><caption>Change of {} against {}, median of pairs and its "
      "95 % "
      "interval; hatched: one pair only, or the interval holds 0</caption>\n<thead><tr><th "
      "scope=\"col\">variant</th>"
      "<th scope=\"col\">all</th>",
      escape_html(metric), escape_html(base));
  for (const std::string& sequence : sequences)
    text += "<th scope=\"col\">" + escape_html(sequence) + "</th>";
  text += "</tr></thead><tbody>";
  const std::vector<AblationRow> rows = ablation(runs, base, metric);
  for (const std::string& variant : distinct(runs, system_label)) {
    if (variant == base) continue;
    text += "\n<tr><th scope=\"row\">" + escape_html(variant) + "</th>";
    for (std::size_t i = 0; i <= sequences.size(); ++i) {
      const std::string sequence = i == 0 ? "" : sequences[i - 1];
      const auto found = std::find_if(rows.begin(), rows.end(), [&](const AblationRow& row) {
        return row.variant == variant && row.sequence == sequence;
      });
      text += found == rows.end() ? "<td class=\"empty\">-</td>" : cell_html(*found);
    }
    text += "</tr>";
  }
  return text + "</tbody></table></div>\n";
}

}  // namespace stillpoint
