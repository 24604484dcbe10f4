// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/result_tables.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "reports/tables/paper_tables.h"

namespace stillpoint::report {
namespace {

bench::StoredRun run_of(const std::string& variant, const std::string& sequence, double ate) {
  bench::StoredRun run;
  run.key = variant + sequence;
  run.identity = {.variant = variant, .sequence = sequence};
  run.metrics = {{"ate_rmse_m", "compat:tum", "m", ate}};
  run.costs = {{"feature_tracking", "call", 10, 2.0, 2.0, 2.0, 2.0}};
  return run;
}

bench::StoredRun crashed_run(const std::string& variant, const std::string& sequence) {
  bench::StoredRun run;
  run.identity = {.variant = variant, .sequence = sequence, .repetition = 2};
  run.outcome = bench::Outcome::kCrashed;
  run.detail = "ended by signal 11";
  return run;
}

TEST(MetricTables, DoNotMarkAnErrorOverFewPoses) {
  std::vector<bench::StoredRun> runs = {run_of("a", "s", 1.0), run_of("b", "s", 0.01)};
  runs[0].metrics.push_back({"coverage", "", "", 0.95});
  runs[1].metrics.push_back({"coverage", "", "", 0.05});
  const ReportTable table = metric_tables(runs).front();
  EXPECT_TRUE(table.rows[0].cells[0].is_best);
  EXPECT_FALSE(table.rows[1].cells[0].is_best);
  EXPECT_EQ(table.rows[1].cells[0].note, "coverage 0.05, others 0.95: not ranked");
}

TEST(MetricTables, DoNotRankARelativeErrorOfFewPairs) {
  std::vector<bench::StoredRun> runs = {run_of("a", "s", 1.0), run_of("b", "s", 1.0)};
  runs[0].metrics = {{"rpe_trans_rmse_m_per_s", "", "m/s", 0.02}, {"rpe_pairs", "", "", 500}};
  runs[1].metrics = {{"rpe_trans_rmse_m_per_s", "", "m/s", 0.001}, {"rpe_pairs", "", "", 2}};
  const std::vector<ReportTable> tables = metric_tables(runs);
  const auto found = std::ranges::find(tables, "rpe_trans_rmse_m_per_s", &ReportTable::name);
  ASSERT_NE(found, tables.end());
  const ReportTable& table = *found;
  EXPECT_TRUE(table.rows[0].cells[0].is_best);
  EXPECT_FALSE(table.rows[1].cells[0].is_best);
  EXPECT_EQ(table.rows[1].cells[0].note, "RPE of only 2 pairs of poses: not ranked");
}

TEST(MetricTables, ShowMediansAndMarkTheBestOfEachColumn) {
  const std::vector<bench::StoredRun> runs = {run_of("a", "s", 1.0), run_of("a", "s", 3.0),
                                              run_of("b", "s", 1.5)};
  const std::vector<ReportTable> tables = metric_tables(runs);
  ASSERT_EQ(tables.size(), 1u);
  const ReportTable& table = tables.front();
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].cells[0].number, 2.0);
  EXPECT_EQ(table.rows[0].cells[0].count, 2u);
  EXPECT_FALSE(table.rows[0].cells[0].is_best);
  EXPECT_TRUE(table.rows[1].cells[0].is_best);
  EXPECT_EQ(table.rows[1].cells[0].run_keys, std::vector<std::string>{"bs"});
  EXPECT_EQ(table.rows[1].cells[0].protocol, "compat:tum");
}

TEST(MetricTables, NameTheMachinesOfRunsThatTheyPool) {
  std::vector<bench::StoredRun> runs = {run_of("a", "s", 1.0), run_of("a", "s", 3.0)};
  for (bench::StoredRun& run : runs) run.machine = "Xeon, 4 processors";
  EXPECT_TRUE(std::ranges::none_of(metric_tables(runs).front().notes, [](const std::string& note) {
    return note.find("machine") != std::string::npos;
  }));
  runs[1].machine = "Orin, 8 processors";
  for (const ReportTable& table : {metric_tables(runs).front(), cost_table(runs)})
    EXPECT_NE(std::ranges::find(table.notes,
                                "Runs of 2 machines are taken together: Orin, 8 processors; Xeon, 4 "
                                "processors; `stillpoint stats` shows them separately."),
              table.notes.end());
}

TEST(MetricTables, MarkFailedAndPartialCells) {
  const std::vector<bench::StoredRun> runs = {run_of("a", "s", 1.0), crashed_run("a", "s"),
                                              crashed_run("b", "s")};
  const ReportTable table = metric_tables(runs).front();
  EXPECT_EQ(table.rows[0].cells[0].state, CellState::kPartial);
  EXPECT_EQ(table.rows[0].cells[0].note, "1 of 2 runs failed: crashed (ended by signal 11)");
  EXPECT_EQ(table.rows[1].cells[0].state, CellState::kFailed);
  EXPECT_EQ(number_text(table.columns[0], table.rows[1].cells[0]), "failed");
}

TEST(MetricTables, ExistIfEveryRunFailed) {
  const std::vector<bench::StoredRun> runs = {crashed_run("a", "s")};
  ASSERT_EQ(metric_tables(runs).size(), 1u);
}

bench::StoredRun timing_run(const std::string& variant, double ms, bool quiet) {
  bench::StoredRun run = run_of(variant, "market", 1.0);
  run.identity.kind = "timing";
  run.costs.front().mean_ms = ms;
  run.metrics.push_back({"quiet", "", "", quiet ? 1.0 : 0.0});
  return run;
}

TEST(CostTable, PrefersUndisturbedTimingRunsAndMarksOtherTimes) {
  const std::vector<bench::StoredRun> runs = {run_of("a", "market", 1.0), timing_run("a", 1.0, true),
                                              timing_run("a", 9.0, false), run_of("b", "market", 1.0),
                                              timing_run("c", 3.0, false)};
  const ReportTable table = cost_table(runs);
  EXPECT_EQ(table.rows[0].cells[0].number, 1.0);  // not the median of 1, 2 and 9 ms
  EXPECT_EQ(table.rows[0].cells[0].note, "");
  EXPECT_EQ(table.rows[1].cells[0].number, 2.0);  // b has no timing runs
  EXPECT_NE(table.rows[1].cells[0].note.find("no timing runs"), std::string::npos);
  EXPECT_EQ(table.rows[2].cells[0].number, 3.0);
  EXPECT_NE(table.rows[2].cells[0].note.find("idle machine"), std::string::npos);
}

TEST(CostTable, CountsFailedTimingRuns) {
  bench::StoredRun failed = timing_run("a", 1.0, false);
  failed.outcome = bench::Outcome::kCrashed;
  const std::vector<bench::StoredRun> runs = {timing_run("a", 1.0, true), failed};
  EXPECT_EQ(cost_table(runs).rows[0].cells[0].state, CellState::kPartial);
}

TEST(MetricTables, MarkTheCpuTimeOfRunsThatShareTheMachine) {
  bench::StoredRun run = run_of("a", "s", 1.0);
  run.metrics = {{"process_cpu_s", "wait4", "s", 2.0}};
  const std::vector<ReportTable> tables = metric_tables(std::vector{run});
  EXPECT_EQ(tables.back().name, "process_cpu_s");
  EXPECT_NE(tables.back().rows[0].cells[0].note.find("kind = \"timing\""), std::string::npos);
}

TEST(MetricTables, SayWhatBoldMeansAndHowManyRunsItRestsOn) {
  const std::vector<bench::StoredRun> runs = {run_of("a", "s", 1.0), run_of("a", "s", 3.0),
                                              run_of("b", "s", 1.5)};
  EXPECT_EQ(metric_tables(runs).front().notes.back(),
            "Bold: smallest median of a column, n = 1 to 2; not a statement of significance.");
}

TEST(MetricTables, ThreeRunsHaveNoInterval) {
  const std::vector<bench::StoredRun> runs = {run_of("a", "s", 1.0), run_of("a", "s", 2.0),
                                              run_of("a", "s", 3.0)};
  const TableCell cell = metric_tables(runs).front().rows[0].cells[0];
  EXPECT_EQ(cell.count, 3u);
  EXPECT_FALSE(cell.interval);
}

TEST(MetricTables, CountEqualRepetitionsOnce) {
  const std::vector<bench::StoredRun> runs(8, run_of("a", "s", 1.0));
  const TableCell cell = metric_tables(runs).front().rows[0].cells[0];
  EXPECT_EQ(cell.count, 1u);
  EXPECT_FALSE(cell.interval);
  EXPECT_EQ(cell.run_keys.size(), 8u);
}

TEST(MetricTables, ExcludeInfiniteValuesAndSaySo) {
  const std::vector<bench::StoredRun> runs = {run_of("a", "s", 1.0),
                                              run_of("a", "s", std::numeric_limits<double>::infinity())};
  const TableCell cell = metric_tables(runs).front().rows[0].cells[0];
  EXPECT_EQ(cell.number, 1.0);
  EXPECT_EQ(cell.note, "1 of 2 runs has an infinite value, which is excluded");
}

TEST(MetricTables, NameAStrictProtocolThatDiffersByAFactorOfTwo) {
  bench::StoredRun run = run_of("a", "s", 1.0);
  run.metrics.push_back({"strict:se3/ate_rmse_m", "", "m", 2.5});
  EXPECT_EQ(metric_tables(std::vector{run}).front().rows[0].cells[0].note,
            "ATE 1.0000 m by compat:tum, ATE 2.5000 m by strict:se3");
}

TEST(PaperTables, AreSelectedByPlanName) {
  EXPECT_EQ(paper_table_of("table2_ablation"), PaperTable::kTable2);
  EXPECT_FALSE(paper_table_of("quick"));
}

TEST(MetricTables, ExcludeSweeps) {
  bench::StoredRun swept = run_of("a", "s", 9.0);
  swept.identity.axis = "synth.walkers";
  const std::vector<bench::StoredRun> runs = {run_of("a", "s", 1.0), swept};
  EXPECT_EQ(metric_tables(runs).front().rows[0].cells[0].number, 1.0);
}

const TableCell& cell_of(const ReportTable& table, const std::string& label, const std::string& source,
                         std::size_t column) {
  for (const TableRow& row : table.rows) {
    if (row.label == label && row.source == source) return row.cells.at(column);
  }
  throw std::out_of_range(label + " " + source);
}

TEST(PaperTables, TableIHasThePapersNumbersAndLayout) {
  const ReportTable table = paper_table(PaperTable::kTable1, {});
  ASSERT_EQ(table.columns.size(), 12u);
  EXPECT_EQ(table.columns[9].group, "Dynamic-VINS");
  // Paper, Table I: fr3_walking_xyz 0.0486, 0.0578, 1.6932 of Dynamic-VINS; Ji et al. are best with 0.0194.
  EXPECT_EQ(cell_of(table, "walking_xyz", "published", 9).number, 0.0486);
  EXPECT_EQ(cell_of(table, "walking_xyz", "published", 10).number, 0.0578);
  EXPECT_EQ(cell_of(table, "walking_xyz", "published", 11).number, 1.6932);
  EXPECT_TRUE(cell_of(table, "walking_xyz", "published", 6).is_best);
  EXPECT_FALSE(cell_of(table, "walking_xyz", "published", 9).is_best);
  EXPECT_EQ(cell_of(table, "walking_xyz", "ours", 9).state, CellState::kEmpty);
}

TEST(PaperTables, DifferenceIsOursMinusPublished) {
  const std::vector<bench::StoredRun> runs = {run_of("dynamic_vins_vo", "walking_static", 0.0100)};
  const ReportTable table = paper_table(PaperTable::kTable1, runs);
  EXPECT_EQ(cell_of(table, "walking_static", "ours", 9).number, 0.0100);
  EXPECT_NEAR(*cell_of(table, "walking_static", "difference", 9).number, 0.0100 - 0.0077, 1e-12);
}

TEST(PaperTables, TableIIFlagsTheIdenticalRowsAndNoOthers) {
  const ReportTable table = paper_table(PaperTable::kTable2, {});
  // Paper, Table II: without circular mask walking_static and walking_rpy both read 0.4111 0.4052 9.8985.
  std::size_t suspicious = 0;
  for (const TableRow& row : table.rows) {
    for (const TableCell& cell : row.cells) suspicious += cell.is_suspicious ? 1 : 0;
  }
  EXPECT_EQ(suspicious, 6u);
  EXPECT_TRUE(cell_of(table, "walking_static", "published", 0).is_suspicious);
  EXPECT_TRUE(cell_of(table, "walking_rpy", "published", 2).is_suspicious);
  EXPECT_FALSE(cell_of(table, "walking_static", "published", 0).note.empty());
}

TEST(PaperTables, TableIIIListsOurTimesBelowThePublishedOnes) {
  const std::vector<bench::StoredRun> runs = {timing_run("dynamic_vins", 2.0, true)};
  const ReportTable table = paper_table(PaperTable::kTable3, runs);
  EXPECT_EQ(cell_of(table, "Dynamic-VINS on Atlas200 DK", "published", 0).number, 15.535);
  EXPECT_EQ(cell_of(table, "VINS-Mono on Atlas200 DK", "published", 3).state, CellState::kEmpty);
  EXPECT_EQ(cell_of(table, "dynamic_vins", "ours", 0).number, 2.0);
}

TEST(PaperTables, TableIIIOmitsDisturbedTimesAndNamesTheRemedy) {
  const std::vector<bench::StoredRun> runs = {run_of("dynamic_vins", "market", 1.0),
                                              timing_run("stillpoint", 1.0, false)};
  const ReportTable table = paper_table(PaperTable::kTable3, runs);
  for (const char* label : {"dynamic_vins", "stillpoint"}) {
    const TableCell& cell = cell_of(table, label, "ours", 0);
    EXPECT_FALSE(cell.number) << label;
    EXPECT_NE(cell.note.find("stillpoint bench table3_runtime"), std::string::npos) << label;
  }
}

}  // namespace
}  // namespace stillpoint::report
