// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/charts/heat_map.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "bench/analysis/run_statistics.h"
#include "reports/tables/escaping.h"
#include "reports/tables/run_cells.h"

namespace stillpoint::report {
namespace {

std::string percent(double ratio) { return fmt::format("{:+.1f} %", 100.0 * ratio); }

/// Color saturation [%]: 60 from a factor of two on, in either direction.
int color_depth(double change) {
  const double octaves = std::log2(std::max(1.0 + change, 1e-3));
  return static_cast<int>(std::lround(60.0 * std::min(std::abs(octaves), 1.0)));
}

/// Hatched where the change is not significant: a single pair, or an interval that contains 0.
std::string cell_html(const bench::AblationRow& row) {
  std::string lost = row.newly_failed == 0 ? "" : fmt::format("<br>{} lost", row.newly_failed);
  if (!row.change) return "<td class=\"empty\">-" + lost + "</td>";
  const eval::RelativeChange& change = *row.change;
  const std::string interval =
      change.count == 1 ? "1 pair" : percent(change.interval.low) + " to " + percent(change.interval.high);
  const bool is_significant = change.count > 1 && (change.interval.low > 0.0 || change.interval.high < 0.0);
  return fmt::format(
      "<td class=\"{}{}\" style=\"--depth:{}%\" title=\"{} pairs\">{}<span class=\"interval\">{}"
      "</span>{}</td>",
      change.median > 0.0 ? "worse" : "better", is_significant ? "" : " insignificant",
      color_depth(change.median), change.count, percent(change.median), interval, lost);
}

std::vector<bench::StoredRun> comparable(std::span<const bench::StoredRun> runs) {
  std::vector<bench::StoredRun> own_runs(runs.begin(), runs.end());
  std::erase_if(own_runs, [](const bench::StoredRun& run) {
    return run.identity.system != "stillpoint" || !run.identity.axis.empty();
  });
  return own_runs;
}

}  // namespace

std::string base_variant(std::span<const bench::StoredRun> runs) {
  const std::vector<std::string> labels = distinct(runs, system_label);
  for (const char* name : {"dynamic_vins", "stillpoint", "vo"}) {
    if (std::find(labels.begin(), labels.end(), name) != labels.end()) return name;
  }
  return labels.empty() ? "" : labels.front();
}

std::string heat_map_html(std::span<const bench::StoredRun> all, const std::string& base,
                          const bench::MetricDescriptor& metric) {
  const std::vector<bench::StoredRun> runs = comparable(all);
  if (distinct(runs, system_label).size() < 2) return "";
  const std::vector<std::string> sequences =
      distinct(runs, [](const bench::RunIdentity& identity) { return identity.sequence; });
  std::string text = fmt::format(
      "<div class=\"table\"><table class=\"heat\"><caption>Change of {} against {}, median of pairs and its "
      "95 % interval; hatched: not significant (one pair only, or the interval contains 0). {}</caption>\n"
      "<thead><tr><th scope=\"col\">variant</th>"
      "<th scope=\"col\">all</th>",
      metric.id, escape_html(base), bench::tooltip(metric));
  for (const std::string& sequence : sequences)
    text += "<th scope=\"col\">" + escape_html(sequence) + "</th>";
  text += "</tr></thead><tbody>";
  const std::vector<bench::AblationRow> rows = bench::ablation(runs, base, std::string(metric.id));
  for (const std::string& variant : distinct(runs, system_label)) {
    if (variant == base) continue;
    text += "\n<tr><th scope=\"row\">" + escape_html(variant) + "</th>";
    for (std::size_t i = 0; i <= sequences.size(); ++i) {
      const std::string sequence = i == 0 ? "" : sequences[i - 1];
      const auto found = std::find_if(rows.begin(), rows.end(), [&](const bench::AblationRow& row) {
        return row.variant == variant && row.sequence == sequence;
      });
      text += found == rows.end() ? "<td class=\"empty\">-</td>" : cell_html(*found);
    }
    text += "</tr>";
  }
  return text + "</tbody></table></div>\n";
}

}  // namespace stillpoint::report
