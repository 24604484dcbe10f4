// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/bench_table.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

BenchRow succeeded_row() {
  BenchRow row;
  row.sequence = "desk";
  row.variant = "vo";
  row.outcome = Outcome::kOk;
  row.metrics = {{"ate_rmse_m", 0.0123456}, {"coverage", 0.5}};
  row.mean_ms[static_cast<std::size_t>(Module::kFeatureTracking)] = 1.234;
  return row;
}

BenchRow failed_row() {
  BenchRow row;
  row.sequence = "desk";
  row.variant = "longer_name";
  row.outcome = Outcome::kCrashed;
  row.reason = "terminated by signal 11";
  return row;
}

TEST(BenchTable, AlignsColumnsAndShowsMissingNumbersAsNotAvailable) {
  const std::vector<BenchRow> rows = {succeeded_row(), failed_row()};
  EXPECT_EQ(
      markdown_table(rows),
      "| sequence | variant     | status  |  ATE m | T.RPE m/s | R.RPE deg/s |  CR | coverage | first pose s "
      "| segments | RPE pairs | track ms |\n"
      "|----------|-------------|---------|-------:|----------:|------------:|----:|---------:|-------------:"
      "|---------:|----------:|---------:|\n"
      "| desk     | vo          | ok      | 0.0123 |       n/a |         n/a | n/a |   0.5000 |          n/a "
      "|      n/a |       n/a |     1.23 |\n"
      "| desk     | longer_name | crashed |    n/a |       n/a |         n/a | n/a |      n/a |          n/a "
      "|      n/a |       n/a |      n/a |\n"
      "\ndesk longer_name crashed: terminated by signal 11\n");
}

TEST(BenchTable, JsonHasFullPrecisionAndNulls) {
  const std::vector<BenchRow> rows = {succeeded_row()};
  const std::string json = json_table("title", rows);
  EXPECT_NE(json.find("\"ate_rmse_m\": 0.0123456"), std::string::npos);
  EXPECT_NE(json.find("\"correct_rate\": null"), std::string::npos);
  EXPECT_NE(json.find("\"feature_tracking\": 1.234"), std::string::npos);
}

TEST(BenchTable, MarksTimesThatOtherProcessesMayHaveChanged) {
  BenchRow row = succeeded_row();
  row.time_source = TimeSource::kShared;
  const std::vector<BenchRow> rows = {row};
  EXPECT_NE(markdown_table(rows).find("\nColumns in ms: " + time_source_note(TimeSource::kShared)),
            std::string::npos);
  EXPECT_NE(json_table("title", rows).find("\"mean_ms_note\": \"times of runs that are no timing runs"),
            std::string::npos);
}

TEST(BenchTable, ShowsTheNumberOfSucceededRuns) {
  BenchRow row = succeeded_row();
  row.runs = 5;
  row.succeeded_runs = 4;
  row.sweep = "detector.simulated.miss_rate = 0.3";
  const std::string table = markdown_table(std::vector<BenchRow>{row});
  EXPECT_NE(table.find("| succeeded |"), std::string::npos) << table;
  EXPECT_NE(table.find(" 4 of 5 |"), std::string::npos) << table;
  EXPECT_NE(table.find("| detector.simulated.miss_rate = 0.3 |"), std::string::npos) << table;
}

}  // namespace
}  // namespace stillpoint::bench
