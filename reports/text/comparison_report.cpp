// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text/comparison_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "reports/tables/escaping.h"
#include "reports/tables/text_table.h"

namespace stillpoint::report {
namespace {

using Json = nlohmann::ordered_json;

std::string percent(double ratio) { return fmt::format("{:+.1f} %", 100.0 * ratio); }

std::vector<std::string> cells_of(const bench::MetricChange& change) {
  return {change.metric,
          change.subject,
          fmt::format("{}", change.change.count),
          fmt::format("{:.4g} {}", change.base_median, change.unit),
          fmt::format("{:.4g} {}", change.head_median, change.unit),
          percent(change.change.median),
          percent(change.change.interval.low) + " to " + percent(change.change.interval.high),
          change_class_name(change.result)};
}

std::string change_table(const std::vector<bench::MetricChange>& changes) {
  TableRows rows = {{"metric", "variant", "pairs", "base", "head", "change", "95 % interval", "result"}};
  for (const bench::MetricChange& change : changes) rows.push_back(cells_of(change));
  return format_table(rows, TableStyle::kMarkdown);
}

Json change_json(const bench::MetricChange& change) {
  return {{"metric", change.metric},
          {"subject", change.subject},
          {"unit", change.unit},
          {"pairs", change.change.count},
          {"base_median", change.base_median},
          {"head_median", change.head_median},
          {"change", change.change.median},
          {"interval", {change.change.interval.low, change.change.interval.high}},
          {"result", change_class_name(change.result)}};
}

Json changes_json(const std::vector<bench::MetricChange>& changes) {
  Json list = Json::array();
  for (const bench::MetricChange& change : changes) list.push_back(change_json(change));
  return list;
}

struct TestCase {
  std::string group;
  std::string name;
  bench::ChangeClass result;
  std::string message;
};

std::string test_case(const TestCase& test) {
  const std::string open = fmt::format("  <testcase classname=\"{}\" name=\"{}\"", escape_html(test.group),
                                       escape_html(test.name));
  switch (test.result) {
    case bench::ChangeClass::kWorse:
      return open +
             fmt::format(">\n    <failure message=\"{}\"/>\n  </testcase>\n", escape_html(test.message));
    case bench::ChangeClass::kInconclusive:
      return open +
             fmt::format(">\n    <skipped message=\"{}\"/>\n  </testcase>\n", escape_html(test.message));
    default:
      return open + "/>\n";
  }
}

}  // namespace

std::string comparison_markdown(const ComparisonTitle& title, const bench::Comparison& comparison) {
  std::string text = fmt::format("# {} compared with {}: {}\n\n", title.head, title.base,
                                 change_class_name(comparison.result()));
  text += fmt::format(
      "{} pairs of runs, {} with bit-equal trajectories; {} newly failed, {} newly succeeded.\n\n",
      comparison.pairs, comparison.bit_equal, comparison.newly_failed, comparison.newly_succeeded);
  if (!comparison.changes.empty()) text += change_table(comparison.changes);
  for (const std::string& note : comparison.notes) text += "\nNote: " + note + ".\n";
  if (comparison.control.empty()) return text;
  return text + "\n## Control: base compared with itself\n\n" + change_table(comparison.control);
}

std::string comparison_json(const ComparisonTitle& title, const bench::Comparison& comparison) {
  Json json;
  json["schema"] = 1;
  json["base"] = title.base;
  json["head"] = title.head;
  json["result"] = change_class_name(comparison.result());
  json["pairs"] = comparison.pairs;
  json["bit_equal"] = comparison.bit_equal;
  json["newly_failed"] = comparison.newly_failed;
  json["newly_succeeded"] = comparison.newly_succeeded;
  json["changes"] = changes_json(comparison.changes);
  json["control"] = changes_json(comparison.control);
  json["notes"] = comparison.notes;
  return json.dump(2) + "\n";
}

std::string comparison_junit(const ComparisonTitle& title, const bench::Comparison& comparison) {
  std::vector<TestCase> tests = {
      {"runs", "no newly failed runs",
       comparison.newly_failed > 0 ? bench::ChangeClass::kWorse : bench::ChangeClass::kSame,
       fmt::format("{} of {} runs succeeded at base and failed at head", comparison.newly_failed,
                   comparison.pairs)}};
  for (const bench::MetricChange& change : comparison.changes) {
    tests.push_back({change.metric, change.subject, change.result,
                     fmt::format("{:.4g} to {:.4g} {}: {}", change.base_median, change.head_median,
                                 change.unit, percent(change.change.median))});
  }
  std::size_t failures = 0;
  std::size_t skipped = 0;
  std::string body;
  for (const TestCase& test : tests) {
    failures += test.result == bench::ChangeClass::kWorse ? 1 : 0;
    skipped += test.result == bench::ChangeClass::kInconclusive ? 1 : 0;
    body += test_case(test);
  }
  return fmt::format(
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{}\" tests=\"{}\" "
             "failures=\"{}\" "
             "skipped=\"{}\">\n",
             escape_html("compare " + title.base + " " + title.head), tests.size(), failures, skipped) +
         body + "</testsuite>\n";
}

}  // namespace stillpoint::report
