// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/result_tables.h"

#include <gtest/gtest.h>

namespace stillpoint::report {
namespace {

bench::StoredRun run_of(const std::string& variant, const std::string& sequence, double ate) {
  bench::StoredRun run;
  run.identity = {.variant = variant, .sequence = sequence};
  run.metrics = {{"ate_rmse_m", "", "m", ate}};
  return run;
}

bench::PublishedTable table() {
  return {
      .name = "t",
      .title = "Errors",
      .metric = "ate_rmse_m",
      .unit = "m",
      .alignment = "rigid",
      .comparability = {"Other images."},
      .sources = {{"A", "A paper"}},
      .rows = {
          {.system = "Quoted",
           .source = "A",
           .input = "RGB-D",
           .note = "odd",
           .values = {{"walking_xyz", 0.05}, {"desk", 1.0}}},
          {.system = "Elsewhere", .source = "A", .input = "RGB-D", .note = "", .values = {{"desk", 2.0}}}}};
}

TEST(PublishedComparison, MarksPublishedRowsAndCitesTheirSource) {
  const std::vector<bench::StoredRun> runs = {
      run_of("vo", "walking_xyz", 0.02), run_of("vo", "walking_xyz", 0.04), run_of("vo", "market", 0.01)};
  const std::string text = published_comparison(runs, table());
  EXPECT_NE(text.find("| vo             | measured     | 0.0300"), std::string::npos)
      << text;  // the median of the measured values only
  EXPECT_NE(text.find("| Quoted (RGB-D) | published, A | 0.0500"), std::string::npos) << text;
  EXPECT_EQ(text.find("Elsewhere"), std::string::npos);  // shares no sequence
  EXPECT_EQ(text.find("market"), std::string::npos);     // no published value
  for (const char* line : {"- Other images.", "- Quoted (A): odd", "- A: A paper", "alignment rigid"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
}

TEST(PublishedComparison, CitesOnlyTheSourcesOfShownRowsInTheTable) {
  bench::PublishedTable published = table();
  published.sources["B"] = "Another paper";
  published.rows[1].source = "B";
  const std::vector<bench::StoredRun> runs = {run_of("vo", "walking_xyz", 0.02)};
  EXPECT_EQ(published_comparison_table(runs, published).notes,
            (std::vector<std::string>{"Other images.", "A: A paper"}));
}

TEST(PublishedComparison, IsEmptyWithoutSharedColumns) {
  EXPECT_EQ(published_comparison(std::vector<bench::StoredRun>{run_of("vo", "market", 0.01)}, table()), "");
}

TEST(PublishedComparison, ComparesOnlyUndisturbedTimes) {
  bench::PublishedTable times = table();
  times.metric = "mean_ms";
  times.rows = {{.system = "Quoted",
                 .source = "A",
                 .input = "RGB-D",
                 .note = "",
                 .values = {{"feature_tracking", 5.0}}}};
  bench::StoredRun run = run_of("vo", "market", 0.01);
  run.costs = {{"feature_tracking", "call", 10, 2.0, 2.0, 2.0, 2.0}};
  const std::string omitted = published_comparison(std::vector{run}, times);
  EXPECT_EQ(omitted.find("2.0000"), std::string::npos) << omitted;
  EXPECT_NE(omitted.find("The times of 1 run are not compared"), std::string::npos) << omitted;
  run.identity.kind = "timing";
  const std::string compared = published_comparison(std::vector{run}, times);
  EXPECT_NE(compared.find("| vo             | measured     | 2.0000"), std::string::npos) << compared;
}

TEST(PublishedComparison, NamesAStrictProtocolThatDiffersByAFactorOfTwo) {
  bench::StoredRun run = run_of("vo", "walking_xyz", 0.02);
  run.metrics.push_back({"strict:se3/ate_rmse_m", "", "m", 0.05});
  const std::string text = published_comparison(std::vector{run}, table());
  EXPECT_NE(text.find("- vo on walking_xyz: ATE 0.0200 m by"), std::string::npos) << text;
}

}  // namespace
}  // namespace stillpoint::report
