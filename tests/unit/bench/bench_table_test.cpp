// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/bench_table.h"

#include <gtest/gtest.h>

#include "bench/plan/bench_plan.h"
#include "bench/plan/child_process.h"
#include "bench/plan/plan_runner.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

BenchRow good_row() {
  BenchRow row;
  row.sequence = "desk";
  row.variant = "vo";
  row.status = "ok";
  row.ate_rmse_m = 0.0123456;
  row.coverage = 0.5;
  row.mean_ms[static_cast<std::size_t>(Module::kFeatureTracking)] = 1.234;
  return row;
}

BenchRow failed_row() {
  BenchRow row;
  row.sequence = "desk";
  row.variant = "longer_name";
  row.status = "failed";
  row.reason = "ended by signal 11";
  return row;
}

TEST(BenchTable, AlignsColumnsAndShowsMissingNumbersAsNotAvailable) {
  const std::vector<BenchRow> rows = {good_row(), failed_row()};
  EXPECT_EQ(
      markdown_table(rows),
      "| sequence | variant     | status |  ATE m | T.RPE m/s | R.RPE deg/s |  CR | coverage | first pose s "
      "| track ms |\n"
      "|----------|-------------|--------|-------:|----------:|------------:|----:|---------:|-------------:"
      "|---------:|\n"
      "| desk     | vo          | ok     | 0.0123 |       n/a |         n/a | n/a |    0.500 |          n/a "
      "|     1.23 |\n"
      "| desk     | longer_name | failed |    n/a |       n/a |         n/a | n/a |      n/a |          n/a "
      "|      n/a |\n"
      "\ndesk longer_name failed: ended by signal 11\n");
}

TEST(BenchTable, JsonKeepsAllDigitsAndNulls) {
  const std::vector<BenchRow> rows = {good_row()};
  const std::string json = json_table("title", rows);
  EXPECT_NE(json.find("\"ate_rmse_m\": 0.0123456"), std::string::npos);
  EXPECT_NE(json.find("\"correct_rate\": null"), std::string::npos);
  EXPECT_NE(json.find("\"feature_tracking\": 1.234"), std::string::npos);
}

TEST(BenchRow, RefusesAFileThatIsNoResult) {
  const TemporaryFolder folder;
  const auto file = folder.write("result.json", "{\"status\": ");
  expect_input_error([&] { static_cast<void>(read_result(file, {})); }, {"result.json: is no result file"});
}

TEST(BenchPlan, TheEmbeddedOneLoads) {
  const BenchPlan plan = load_plan("quick");
  EXPECT_FALSE(plan.rendered.sequences.empty());
  EXPECT_FALSE(plan.recorded.sequences.empty());
}

TEST(BenchPlan, NamesTheNearestKeyAndTheVariantThatIsNotThere) {
  const TemporaryFolder folder;
  const std::string misspelt = folder.write("a.toml", "[rendered]\nsecond = 3").string();
  expect_input_error([&] { static_cast<void>(load_plan(misspelt)); },
                     {"a.toml:2: unknown key \"rendered.second\"; did you mean \"rendered.seconds\"?"});
  const std::string unknown = folder.write("b.toml", "rendered.variants = [\"voo\"]").string();
  expect_input_error([&] { static_cast<void>(load_plan(unknown)); }, {"config \"voo\"", "\"vo\"?"});
}

TEST(PlanRunner, ShowsARecordedSequenceThatIsNotAtHandAsSkipped) {
  const TemporaryFolder folder;
  BenchPlan plan;
  plan.recorded = {.sequences = {"no_such_recording"}, .variants = {"vo"}};
  const std::vector<BenchRow> rows = run_plan(
      plan, folder.path(), {.on_step = [](const std::string&) {}, .stop_requested = [] { return false; }});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].status, "skipped");
  EXPECT_NE(rows[0].reason.find("STILLPOINT_DATA"), std::string::npos);
}

TEST(PlanRunner, ShowsASequenceThatCannotBeRenderedAsFailed) {
  const TemporaryFolder folder;
  BenchPlan plan;
  plan.rendered.sequences = {"no_such_preset"};
  plan.rendered.variants = {"vo"};
  const std::vector<BenchRow> rows = run_plan(
      plan, folder.path(), {.on_step = [](const std::string&) {}, .stop_requested = [] { return false; }});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].status, "failed");
  EXPECT_NE(rows[0].reason.find("no_such_preset"), std::string::npos);
}

// The program under test here is this very test: a child runs one of the two below.
TEST(ChildProcess, DISABLED_SaysTwoLinesAndEndsWithFive) {
  std::fputs("first\nlast words\n", stderr);
  std::_Exit(5);
}
TEST(ChildProcess, DISABLED_EndsByASignal) { std::abort(); }

ChildResult run_child(const std::string& test) {
  return run_self({"--gtest_also_run_disabled_tests", "--gtest_filter=ChildProcess.DISABLED_" + test},
                  [] { return false; });
}

TEST(ChildProcess, ReportsExitCodeAndLastMessage) {
  const ChildResult child = run_child("SaysTwoLinesAndEndsWithFive");
  EXPECT_EQ(child.exit_code, 5);
  EXPECT_EQ(child.last_message, "last words");
}

TEST(ChildProcess, ReportsTheSignalThatEndedIt) {
  EXPECT_EQ(run_child("EndsByASignal").exit_code, 128 + 6);  // SIGABRT is 6
}

}  // namespace
}  // namespace stillpoint
