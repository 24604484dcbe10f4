// SPDX-License-Identifier: BSD-3-Clause
#include "reports/dashboard/dashboard.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/store/store_writer.h"
#include "reports/dashboard/headline.h"
#include "reports/dashboard/history_text.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::report {
namespace {

using Json = nlohmann::json;

const std::string kHostile =
    "\"><img src=x onerror=alert(1)>'</script>|\\$&%_#{}~^\n\xff\xE2\x80\xAE" + std::string(3000, 'n');

/// Two commits of one benchmark case; the run of the second one crashed.
std::filesystem::path failing_store(const TemporaryFolder& folder, const std::string& name) {
  std::filesystem::path file = folder.path() / "s.sqlite";
  bench::StoreWriter writer(file);
  for (const bool is_second : {false, true}) {
    const bench::RunIdentity identity{.variant = name, .sequence = name, .build = is_second ? name : "first"};
    static_cast<void>(writer.acquire(identity));
    bench::RunOutcome outcome{.outcome = is_second ? bench::Outcome::kCrashed : bench::Outcome::kOk,
                              .metrics = {{name, name, name, 0.5}},
                              .costs = {{"window_solve", "call", 3, 1.5, 1.0, 2.0, 3.0}}};
    if (!is_second)
      outcome.manifest =
          Json{{"host", {{"cpu", kHostile}}}}.dump(-1, ' ', false, Json::error_handler_t::replace);
    writer.finish(identity, outcome);
  }
  writer.record_plan({.name = name, .title = name, .text = name, .run_keys = {}});
  return file;
}

const std::string& text_of(const std::vector<bench::OutputFile>& files, const std::string& name) {
  for (const bench::OutputFile& file : files) {
    if (file.name == name) return file.text;
  }
  throw std::out_of_range(name);
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Dashboard, ConsistsOfIndexRegressionsAndAPageForEachCommit) {
  const TemporaryFolder folder;
  const std::vector<bench::OutputFile> files = dashboard_files(bench::Store(failing_store(folder, "b")));
  ASSERT_EQ(files.size(), 6u);
  EXPECT_NE(text_of(files, "badge.svg").find("benchmarks: 1 open regression"), std::string::npos);
  const Json regressions = Json::parse(text_of(files, "regressions.json"));
  ASSERT_EQ(regressions["open"].size(), 1u);
  EXPECT_EQ(regressions["open"][0]["metric"], bench::metric_id::kFailedRuns);
  EXPECT_EQ(regressions["open"][0]["last_commit_before"], "first");
  EXPECT_EQ(regressions["open"][0]["first_commit_after"], "b");
  EXPECT_NE(text_of(files, "regressions.md").find("| failed\\_runs | first..b | 1 |"), std::string::npos);
}

TEST(Dashboard, DoesNotDependOnTheLocationOfTheStore) {
  const TemporaryFolder folder;
  const std::filesystem::path file = failing_store(folder, "b");
  const std::filesystem::path copy = folder.path() / "another name";
  std::filesystem::copy_file(file, copy);
  const std::vector<bench::OutputFile> first = dashboard_files(bench::Store(file));
  const std::vector<bench::OutputFile> second = dashboard_files(bench::Store(copy));
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].text, second[i].text) << first[i].name;
}

TEST(Dashboard, LoadsNothingFromTheNetwork) {
  const TemporaryFolder folder;
  for (const bench::OutputFile& file : dashboard_files(bench::Store(failing_store(folder, "b")))) {
    const std::size_t address = file.text.find("http://");
    // The namespace of SVG is a name, not an address.
    EXPECT_TRUE(address == std::string::npos || file.name == "badge.svg") << file.name;
    EXPECT_EQ(file.text.find(" src=\""), std::string::npos) << file.name;
  }
}

TEST(Dashboard, EscapesHostileNames) {
  const TemporaryFolder folder;
  const TemporaryFolder harmless_folder;
  const std::vector<bench::OutputFile> files = dashboard_files(bench::Store(failing_store(folder, kHostile)));
  const std::vector<bench::OutputFile> harmless =
      dashboard_files(bench::Store(failing_store(harmless_folder, "b")));
  ASSERT_EQ(files.size(), harmless.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (const char letter : files[i].name)
      EXPECT_TRUE(std::isalnum(static_cast<unsigned char>(letter)) != 0 ||
                  std::string("./-").find(letter) != std::string::npos);
    EXPECT_TRUE(std::none_of(files[i].text.begin(), files[i].text.end(),
                             [](char letter) { return letter == '\xff'; }));
    if (!files[i].name.ends_with(".html")) continue;
    EXPECT_EQ(files[i].text.find("<img"), std::string::npos) << files[i].name.substr(0, 40);
    EXPECT_EQ(count_of(files[i].text, "</script>"), count_of(harmless[i].text, "</script>"));
  }
  const std::string& index = text_of(files, "index.html");
  const std::string open = "id=\"index\">";
  const std::size_t begin = index.find(open) + open.size();
  EXPECT_FALSE(Json::parse(index.substr(begin, index.find("</script>", begin) - begin)).empty());
  EXPECT_EQ(Json::parse(text_of(files, "regressions.json"))["open"].size(), 1u);
  // First line, header, delimiter row, one row, and what was tested; the bars within names are escaped.
  const std::string& markdown = text_of(files, "regressions.md");
  EXPECT_EQ(count_of(markdown, "\n"), 7u);
  EXPECT_EQ(count_of(markdown.substr(markdown.rfind("| failed")), " |"), 7u);
}

TEST(Dashboard, ErrorForAnEmptyStoreExplainsHowToCreateRuns) {
  const TemporaryFolder folder;
  { const bench::StoreWriter writer(folder.path() / "s"); }
  expect_input_error([&] { static_cast<void>(dashboard_files(bench::Store(folder.path() / "s"))); },
                     {"no finished runs", "stillpoint bench"});
}

/// One series of "ms" over three commits, 1 then 2.
bench::CommitHistory stepping_history() {
  bench::CommitHistory history;
  history.commits = {{"aa", "t0"}, {"bb", "t1"}, {"cc", "t2"}};
  bench::HistorySeries series{.subject = {},
                              .plans = {},
                              .metric = "window_solve",
                              .unit = "ms",
                              .gated = bench::gated_metric("ms"),
                              .commits = {0, 2},
                              .values = {1.0, 2.0},
                              .runs = {1, 1}};
  series.subject.variant = "vo";
  series.subject.sequence = "office";
  series.subject.mode = "sequential";
  series.subject.kind = "accuracy";
  history.series = {series};
  return history;
}

bench::LevelShift shift_of(double change, std::size_t after) {
  return {.series = 0,
          .before = 0,
          .after = after,
          .level_before = 1.0,
          .level_after = 1.0 + change,
          .change = eval::RelativeChange{.count = 8,
                                         .median = change,
                                         .p_value = 0.001,
                                         .interval = eval::Interval{change - 0.1, change + 0.1}},
          .p_value = 0.001,
          .state = bench::ChangeState::kOpen,
          .reason = ""};
}

TEST(CommitPage, ComparesAMetricWithItsPreviousMeasurement) {
  const std::string page = commit_html(stepping_history(), {.shifts = {shift_of(1.0, 2)}, .drifts = {}}, 2);
  EXPECT_NE(page.find("<td>1 ms</td><td>2 ms</td><td>+100.0 %</td></tr>"), std::string::npos);  // 2 / 1 - 1
  EXPECT_NE(page.find("<td>n = 8, +90.0 to +110.0 %</td>"), std::string::npos);
  EXPECT_NE(page.find("previous: bb"), std::string::npos);
}

TEST(CommitPage, StatesWhenThereIsNoEarlierMeasurement) {
  const std::string page = commit_html(stepping_history(), {}, 0);
  EXPECT_NE(page.find("No metric of this commit has an earlier measurement"), std::string::npos);
  EXPECT_NE(page.find("No change points at this commit"), std::string::npos);
}

TEST(GroupedShifts, AreSortedBySizeInMargins) {
  const bench::HistoryChanges changes{.shifts = {shift_of(0.1, 1), shift_of(0.3, 2), shift_of(-0.4, 1)},
                                      .drifts = {}};
  const std::vector<ShiftGroup> groups =
      grouped_shifts(stepping_history(), changes, bench::ChangeState::kOpen);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[1].after, 2u);
  ASSERT_EQ(groups[0].shifts.size(), 2u);
  EXPECT_EQ(groups[0].shifts.front()->change->median, -0.4);
  EXPECT_TRUE(grouped_shifts(stepping_history(), changes, bench::ChangeState::kResolved).empty());
}

/// `count` commits with a cost near 1 and an error of 1; the newest `steps` have 1.3 and 1.3.
bench::CommitHistory two_metrics(std::size_t count, std::size_t steps) {
  bench::CommitHistory history = stepping_history();
  history.commits.clear();
  bench::HistorySeries& cost = history.series.front();
  cost.commits.clear();
  cost.values.clear();
  bench::HistorySeries error = cost;
  error.metric = bench::metric_id::kAte;
  error.gated = bench::gated_metric(error.metric);
  for (std::size_t i = 0; i < count; ++i) {
    history.commits.push_back({std::string(2, static_cast<char>('a' + i)), "t"});
    const double step = i + steps >= count ? 1.3 : 1.0;
    cost.commits.push_back(i);
    cost.values.push_back(step + 0.01 * static_cast<double>(i % 3));
    error.commits.push_back(i);
    error.values.push_back(step);
  }
  history.series.push_back(error);
  return history;
}

TEST(SuspectedChanges, AreListedFromTheFirstCommitOnAccuracyFirst) {
  const bench::CommitHistory history = two_metrics(6, 1);
  const std::vector<bench::SuspectedChange> found = bench::suspected_changes(history, {});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(history.series[found[0].series].metric, bench::metric_id::kAte);
  EXPECT_EQ(p_label(found[0]), "exact");
  EXPECT_EQ(found[1].p_value, 1.0);  // one against five: 2 / 6 at best, times five
  EXPECT_TRUE(found[1].worse);
  EXPECT_LT(bench::suspected_changes(two_metrics(20, 4), {}).back().p_value, 0.005);
  EXPECT_TRUE(bench::suspected_changes(two_metrics(6, 0), {}).empty());
  const std::string text = regressions_markdown(history, {});
  EXPECT_EQ(text.find("No open regressions. 2 suspected changes of the newest commits, 2 for the worse"), 0u);
  // The step of the newest commit is none of the scatter that hides steps.
  const double margin = bench::gated_metric(bench::metric_id::kAte)->gate->margin;
  EXPECT_EQ(bench::visible_step(history, {}, bench::MetricFamily::kAccuracy), margin);
  EXPECT_NE(text.find("6 commits: steps of more than "), std::string::npos) << text;
  EXPECT_FALSE(has_findings(history, {}));
}

TEST(SuspectedChanges, AreNotConfirmedShifts) {
  const bench::CommitHistory history = two_metrics(6, 1);
  EXPECT_EQ(bench::suspected_changes(history, {.shifts = {shift_of(0.3, 5)}, .drifts = {}}).size(), 1u);
}

TEST(VisibleStep, IsThatOfTheNewestLevel) {
  const bench::CommitHistory history = two_metrics(9, 5);
  bench::LevelShift shift = shift_of(0.3, 4);
  shift.series = history.series.size() - 1;  // the error
  const double margin = bench::gated_metric(bench::metric_id::kAte)->gate->margin;
  const auto accuracy = bench::MetricFamily::kAccuracy;
  EXPECT_EQ(bench::visible_step(history, {.shifts = {shift}, .drifts = {}}, accuracy), margin);
  EXPECT_GT(bench::visible_step(history, {}, accuracy), margin);
}

TEST(HistoryText, AnIntervalHasItsNumberOfValuesAndIsAbsentIfTheyDoNotSupportOne) {
  bench::LevelShift shift = shift_of(1.0, 2);
  EXPECT_EQ(interval_label(shift), "n = 8, +90.0 to +110.0 %");
  shift.change->count = 3;
  shift.change->interval.reset();
  EXPECT_EQ(interval_label(shift), "n = 3, no interval");
  const Json json =
      Json::parse(regressions_json(stepping_history(), {.shifts = {shift}, .drifts = {}}))["open"][0];
  EXPECT_TRUE(json["interval"].is_null());
  EXPECT_EQ(json["n"], 3);
}

TEST(HistoryText, ShortensCommitsAndDistinguishesSubjects) {
  EXPECT_EQ(commit_label("0123456789012345678901234567890123456789+abcdef"), "0123456789+abcdef");
  EXPECT_EQ(commit_label("base-1"), "base-1");
  EXPECT_EQ(commit_label("\xC3\xA4" + std::string(40, 'x')), "\xC3\xA4" + std::string(23, 'x'));
  bench::HistorySubject subject = stepping_history().series.front().subject;
  EXPECT_EQ(subject_label(subject), "vo on office");
  subject.seed = 2;
  subject.axis = "rate";
  subject.axis_value = 0.5;
  subject.mode = "realtime";
  EXPECT_EQ(subject_label(subject), "vo on office, rate = 0.5, seed 2, realtime");
}

}  // namespace
}  // namespace stillpoint::report
