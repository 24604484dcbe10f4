// SPDX-License-Identifier: BSD-3-Clause
#include "reports/comparison_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "reports/tables/escaping.h"
#include "reports/text_table.h"

namespace stillpoint {
namespace {

using Json = nlohmann::ordered_json;

std::string percent(double share) { return fmt::format("{:+.1f} %", 100.0 * share); }

std::vector<std::string> cells_of(const MetricChange& change) {
  return {change.metric,
          change.subject,
          fmt::format("{}", change.change.count),
          fmt::format("{:.4g} {}", change.base_median, change.unit),
          fmt::format("{:.4g} {}", change.head_median, change.unit),
          percent(change.change.median),
          percent(change.change.interval.low) + " to " + percent(change.change.interval.high),
          verdict_name(change.verdict)};
}

std::string change_table(const std::vector<MetricChange>& changes) {
  TableRows rows = {{"metric", "of", "pairs", "base", "head", "change", "95 % interval", "verdict"}};
  for (const MetricChange& change : changes) rows.push_back(cells_of(change));
  return format_table(rows, TableStyle::kMarkdown);
}

Json change_json(const MetricChange& change) {
  return {{"metric", change.metric},
          {"subject", change.subject},
          {"unit", change.unit},
          {"pairs", change.change.count},
          {"base_median", change.base_median},
          {"head_median", change.head_median},
          {"change", change.change.median},
          {"interval", {change.change.interval.low, change.change.interval.high}},
          {"verdict", verdict_name(change.verdict)}};
}

Json changes_json(const std::vector<MetricChange>& changes) {
  Json list = Json::array();
  for (const MetricChange& change : changes) list.push_back(change_json(change));
  return list;
}

struct TestCase {
  std::string group;
  std::string name;
  ChangeVerdict verdict;
  std::string message;
};

std::string test_case(const TestCase& test) {
  const std::string open = fmt::format("  <testcase classname=\"{}\" name=\"{}\"", escape_html(test.group),
                                       escape_html(test.name));
  switch (test.verdict) {
    case ChangeVerdict::kWorse:
      return open +
             fmt::format(">\n    <failure message=\"{}\"/>\n  </testcase>\n", escape_html(test.message));
    case ChangeVerdict::kInconclusive:
      return open +
             fmt::format(">\n    <skipped message=\"{}\"/>\n  </testcase>\n", escape_html(test.message));
    default:
      return open + "/>\n";
  }
}

}  // namespace

std::string comparison_markdown(const ComparisonTitle& title, const Comparison& comparison) {
  std::string text =
      fmt::format("# {} against {}: {}\n\n", title.head, title.base, verdict_name(comparison.verdict()));
  text += fmt::format("{} pairs of runs, {} with bit-equal trajectories; {} newly lost, {} newly won.\n\n",
                      comparison.pairs, comparison.bit_equal, comparison.newly_lost, comparison.newly_won);
  if (!comparison.changes.empty()) text += change_table(comparison.changes);
  for (const std::string& note : comparison.notes) text += "\nNote: " + note + ".\n";
  if (comparison.control.empty()) return text;
  return text + "\n## Control: base against itself\n\n" + change_table(comparison.control);
}

std::string comparison_json(const ComparisonTitle& title, const Comparison& comparison) {
  Json json;
  json["schema"] = 1;
  json["base"] = title.base;
  json["head"] = title.head;
  json["verdict"] = verdict_name(comparison.verdict());
  json["pairs"] = comparison.pairs;
  json["bit_equal"] = comparison.bit_equal;
  json["newly_lost"] = comparison.newly_lost;
  json["newly_won"] = comparison.newly_won;
  json["changes"] = changes_json(comparison.changes);
  json["control"] = changes_json(comparison.control);
  json["notes"] = comparison.notes;
  return json.dump(2) + "\n";
}

std::string comparison_junit(const ComparisonTitle& title, const Comparison& comparison) {
  std::vector<TestCase> tests = {{"runs", "no run is newly lost",
                                  comparison.newly_lost > 0 ? ChangeVerdict::kWorse : ChangeVerdict::kSame,
                                  fmt::format("{} of {} runs ended well at base and not at head",
                                              comparison.newly_lost, comparison.pairs)}};
  for (const MetricChange& change : comparison.changes) {
    tests.push_back({change.metric, change.subject, change.verdict,
                     fmt::format("{:.4g} to {:.4g} {}: {}", change.base_median, change.head_median,
                                 change.unit, percent(change.change.median))});
  }
  std::size_t failures = 0;
  std::size_t skipped = 0;
  std::string body;
  for (const TestCase& test : tests) {
    failures += test.verdict == ChangeVerdict::kWorse ? 1 : 0;
    skipped += test.verdict == ChangeVerdict::kInconclusive ? 1 : 0;
    body += test_case(test);
  }
  return fmt::format(
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{}\" tests=\"{}\" "
             "failures=\"{}\" "
             "skipped=\"{}\">\n",
             escape_html("compare " + title.base + " " + title.head), tests.size(), failures, skipped) +
         body + "</testsuite>\n";
}

}  // namespace stillpoint
