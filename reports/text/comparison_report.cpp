// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text/comparison_report.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

using Json = nlohmann::ordered_json;

std::string change_interval_text(const bench::MetricChange& change) {
  if (change.test == bench::ChangeTest::kExact) return "exact";
  const std::optional<eval::Interval>& interval = change.change.interval;
  if (!interval) return fmt::format("- (n = {})", change.change.count);
  return amount_text(change, interval->low) + " to " + amount_text(change, interval->high);
}

const char* test_name(bench::ChangeTest test) {
  switch (test) {
    case bench::ChangeTest::kExact:
      return "exact";
    case bench::ChangeTest::kPairs:
      return "signed_rank";
    case bench::ChangeTest::kReplicates:
      return "rank_sum";
  }
  return "";
}

Json interval_json(const std::optional<eval::Interval>& interval) {
  return interval ? Json({interval->low, interval->high}) : Json(nullptr);
}

std::string p_text(const bench::MetricChange& change) {
  return change.test == bench::ChangeTest::kExact ? "exact" : fmt::format("{:.2g}", change.change.p_value);
}

/// A change that is larger than the margin, but not significant, is said to be one.
std::string result_text(const bench::MetricChange& change) {
  if (!change.decides) return change.changed ? "changed, reported only" : "reported only";
  const std::string name = change_class_name(change.result);
  const bool is_unproven = change.changed && change.result == bench::ChangeClass::kInconclusive;
  return is_unproven ? "changed, " + name : name;
}

std::vector<std::string> cells_of(const bench::MetricChange& change) {
  return {change.metric,
          change.subject,
          fmt::format("{}", change.change.count),
          fmt::format("{:.4g} {}", change.base_median, change.unit),
          fmt::format("{:.4g} {}", change.head_median, change.unit),
          amount_text(change, change.change.median),
          change_interval_text(change),
          p_text(change),
          result_text(change)};
}

std::string change_table(const std::vector<bench::MetricChange>& changes) {
  TableRows rows = {{"metric", "variant", "n", "base", "head", "change", "95 % interval", "p", "result"}};
  for (const bench::MetricChange& change : changes) rows.push_back(cells_of(change));
  return format_table(rows, TableStyle::kMarkdown);
}

Json change_json(const bench::MetricChange& change) {
  const bool is_exact = change.test == bench::ChangeTest::kExact;
  return {{"metric", change.metric},
          {"subject", change.subject},
          {"unit", change.unit},
          {"n", change.change.count},
          {"base_median", change.base_median},
          {"head_median", change.head_median},
          {"change", change.change.median},
          {"change_is", change.is_absolute ? "difference" : "ratio"},
          {"changed", change.changed},
          {"test", test_name(change.test)},
          {"p", is_exact ? Json(nullptr) : Json(change.change.p_value)},
          {"interval", interval_json(change.change.interval)},
          {"adjusted_interval", interval_json(change.adjusted_interval)},
          {"needed_pairs", change.needed == 0 ? Json(nullptr) : Json(change.needed)},
          {"decides", change.decides},
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

/// The JUnit element of a result; empty for a passed test.
std::string element_of(bench::ChangeClass result) {
  if (result == bench::ChangeClass::kError) return "error";
  if (result == bench::ChangeClass::kWorse || result == bench::ChangeClass::kMissing) return "failure";
  return result == bench::ChangeClass::kInconclusive ? "skipped" : "";
}

std::string test_case(const TestCase& test) {
  const std::string open = fmt::format("  <testcase classname=\"{}\" name=\"{}\"", escape_html(test.group),
                                       escape_html(test.name));
  const std::string element = element_of(test.result);
  if (element.empty()) return open + "/>\n";
  return open +
         fmt::format(">\n    <{} message=\"{}\"/>\n  </testcase>\n", element, escape_html(test.message));
}

bench::ChangeClass missing_class(const bench::Comparison& comparison) {
  bench::ChangeClass worst = bench::ChangeClass::kSame;
  for (const bench::MissingResult& missing : comparison.missing) {
    if (!comparison.missing_allowed) worst = std::max(worst, missing.result);
  }
  return worst;
}

std::string missing_sentence(const bench::Comparison& comparison) {
  std::string text;
  for (const bench::MissingResult& missing : comparison.missing)
    text +=
        fmt::format("{}{} of {}", text.empty() ? "missing in HEAD: " : ", ", missing.what, missing.subject);
  return text;
}

/// What base has and head lacks; empty if nothing is missing.
std::string missing_table(const bench::Comparison& comparison) {
  if (comparison.missing.empty()) return "";
  TableRows rows = {{"missing in HEAD", "of", "runs of base", "runs of head", "result"}};
  for (const bench::MissingResult& missing : comparison.missing) {
    rows.push_back({missing.what, missing.subject, fmt::format("{}", missing.base),
                    fmt::format("{}", missing.head),
                    comparison.missing_allowed ? "allowed" : change_class_name(missing.result)});
  }
  const char* remedy = comparison.missing_allowed
                           ? ""
                           : "A renamed or removed result is accepted with `--allow-missing`; infinite and "
                             "absent values are no values.\n\n";
  return format_table(rows, TableStyle::kMarkdown) + "\n" + remedy;
}

/// What was not measured alike, and is not compared; empty if there is nothing.
std::string unlike_table(const bench::Comparison& comparison) {
  if (comparison.unlike.empty()) return "";
  TableRows rows = {{"not compared: unlike", "of", "base", "head"}};
  for (const bench::UnlikeResult& unlike : comparison.unlike)
    rows.push_back({unlike.what, unlike.subject, unlike.base, unlike.head});
  return format_table(rows, TableStyle::kMarkdown) + "\n";
}

std::string unlike_sentence(const bench::Comparison& comparison) {
  std::string text;
  for (const bench::UnlikeResult& unlike : comparison.unlike) {
    text += fmt::format("{}{} of {}: {} and {}", text.empty() ? "not compared: " : "; ", unlike.what,
                        unlike.subject, unlike.base, unlike.head);
  }
  return text;
}

Json unlike_json(const bench::Comparison& comparison) {
  Json list = Json::array();
  for (const bench::UnlikeResult& unlike : comparison.unlike) {
    list.push_back(
        {{"what", unlike.what}, {"subject", unlike.subject}, {"base", unlike.base}, {"head", unlike.head}});
  }
  return list;
}

Json missing_json(const bench::Comparison& comparison) {
  Json list = Json::array();
  for (const bench::MissingResult& missing : comparison.missing) {
    list.push_back({{"what", missing.what},
                    {"subject", missing.subject},
                    {"base", missing.base},
                    {"head", missing.head},
                    {"result", change_class_name(missing.result)}});
  }
  return list;
}

/// Whether runs were compared, and whether any failed.
std::vector<TestCase> tests_of_runs(const bench::Comparison& comparison) {
  using enum bench::ChangeClass;
  const bool both_failed = comparison.base_failed > comparison.newly_succeeded;
  const std::string counts = count_sentence(comparison);
  return {{"runs", "runs are compared", comparison.has_result() ? kSame : kError, counts},
          {"runs", "runs do not fail more often", comparison.failures, counts},
          {"runs", "nothing is missing in HEAD", missing_class(comparison), missing_sentence(comparison)},
          {"runs", "everything is measured alike", comparison.unlike.empty() ? kSame : kInconclusive,
           unlike_sentence(comparison)},
          {"runs", "no runs that fail on both sides", both_failed ? kInconclusive : kSame,
           counts + "; the first failure: " + comparison.first_failure}};
}

std::vector<TestCase> tests_of(const bench::Comparison& comparison) {
  std::vector<TestCase> tests = tests_of_runs(comparison);
  for (const bench::MetricChange& change : comparison.changes) {
    tests.push_back({change.metric, change.subject, change.result,
                     fmt::format("{:.4g} to {:.4g} {}: {}, n = {}, p = {}", change.base_median,
                                 change.head_median, change.unit, amount_text(change, change.change.median),
                                 change.change.count, p_text(change))});
  }
  return tests;
}

/// @param element of JUnit, see `element_of`
std::size_t count_of(const std::vector<TestCase>& tests, const std::string& element) {
  return static_cast<std::size_t>(
      std::ranges::count_if(tests, [&](const TestCase& test) { return element_of(test.result) == element; }));
}

}  // namespace

std::string comparison_markdown(const ComparisonTitle& title, const bench::Comparison& comparison) {
  std::string text = fmt::format("# {} compared with {}: {}\n\n", title.head, title.base,
                                 change_class_name(comparison.result()));
  text += count_sentence(comparison) + ".\n\n";
  text += missing_table(comparison) + unlike_table(comparison);
  if (!comparison.first_failure.empty()) text += "First failure: " + comparison.first_failure + ".\n\n";
  if (!comparison.has_result()) text += "Nothing was compared: no pair has a metric on both sides.\n";
  if (!comparison.changes.empty()) {
    text += change_table(comparison.changes);
    text += fmt::format(
        "\n{} metrics differ and are tested; a change is significant if p <= {:.2g} (false discovery rate 5 "
        "%).\n",
        comparison.family.tests, comparison.family.level);
  }
  for (const std::string& note : comparison.notes) text += "\nNote: " + note + ".\n";
  if (comparison.control.empty()) return text;
  return text + "\n## Control: base compared with itself\n\n" + change_table(comparison.control);
}

std::string comparison_json(const ComparisonTitle& title, const bench::Comparison& comparison) {
  Json json;
  json["schema"] = 2;
  json["base"] = title.base;
  json["head"] = title.head;
  json["result"] = change_class_name(comparison.result());
  json["pairs"] = comparison.pairs;
  json["compared"] = comparison.compared;
  json["bit_equal"] = comparison.bit_equal;
  json["base_failed"] = comparison.base_failed;
  json["head_failed"] = comparison.head_failed;
  json["newly_failed"] = comparison.newly_failed;
  json["newly_succeeded"] = comparison.newly_succeeded;
  json["only_in_base"] = comparison.only_in_base;
  json["only_in_head"] = comparison.only_in_head;
  json["first_failure"] = comparison.first_failure.empty() ? Json(nullptr) : Json(comparison.first_failure);
  json["missing"] = missing_json(comparison);
  json["unlike"] = unlike_json(comparison);
  json["missing_allowed"] = comparison.missing_allowed;
  json["tests"] = comparison.family.tests;
  json["level"] = comparison.family.level;
  json["changes"] = changes_json(comparison.changes);
  json["control"] = changes_json(comparison.control);
  json["notes"] = comparison.notes;
  return json.dump(2) + "\n";
}

std::string comparison_junit(const ComparisonTitle& title, const bench::Comparison& comparison) {
  const std::vector<TestCase> tests = tests_of(comparison);
  std::string body;
  for (const TestCase& test : tests) body += test_case(test);
  return fmt::format(
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{}\" tests=\"{}\" "
             "failures=\"{}\" errors=\"{}\" skipped=\"{}\">\n",
             escape_html("compare " + title.base + " " + title.head), tests.size(),
             count_of(tests, "failure"), count_of(tests, "error"), count_of(tests, "skipped")) +
         body + "</testsuite>\n";
}

}  // namespace stillpoint::report
