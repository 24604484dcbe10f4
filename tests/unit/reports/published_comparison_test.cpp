// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text/published_comparison.h"

#include <gtest/gtest.h>

#include "reports/text/comparison_report.h"

namespace stillpoint::report {
namespace {

bench::StoredRun run_of(const std::string& variant, const std::string& sequence, double ate) {
  bench::StoredRun run;
  run.identity = {.variant = variant, .sequence = sequence};
  run.metrics = {{"ate_rmse_m", "", "m", ate}};
  return run;
}

bench::PublishedTable table() {
  return {.name = "t",
          .title = "Errors",
          .metric = "ate_rmse_m",
          .unit = "m",
          .alignment = "rigid",
          .comparability = {"Other images."},
          .sources = {{"A", "A paper"}},
          .rows = {{.system = "Quoted",
                    .source = "A",
                    .note = "odd",
                    .values = {{"walking_xyz", 0.05}, {"desk", 1.0}}},
                   {.system = "Elsewhere", .source = "A", .note = "", .values = {{"desk", 2.0}}}}};
}

TEST(PublishedComparison, MarksPublishedRowsAndCitesTheirSource) {
  const std::vector<bench::StoredRun> runs = {
      run_of("vo", "walking_xyz", 0.02), run_of("vo", "walking_xyz", 0.04), run_of("vo", "market", 0.01)};
  const std::string text = published_comparison(runs, table());
  EXPECT_NE(text.find("| vo     | measured     | 0.0300"), std::string::npos)
      << text;  // the median of the measured values only
  EXPECT_NE(text.find("| Quoted | published, A | 0.0500"), std::string::npos) << text;
  EXPECT_EQ(text.find("Elsewhere"), std::string::npos);  // shares no sequence
  EXPECT_EQ(text.find("market"), std::string::npos);     // no published value
  for (const char* line : {"- Other images.", "- Quoted (A): odd", "- A: A paper", "alignment rigid"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
}

TEST(PublishedComparison, IsEmptyWithoutSharedColumns) {
  EXPECT_EQ(published_comparison(std::vector<bench::StoredRun>{run_of("vo", "market", 0.01)}, table()), "");
}

bench::Comparison comparison() {
  bench::MetricChange slower{.metric = "feature_tracking",
                             .subject = "vo",
                             .unit = "ms",
                             .base_median = 10.0,
                             .head_median = 10.5,
                             .change = {.count = 20, .median = 0.05, .interval = {0.04, 0.06}},
                             .adjusted_interval = {0.03, 0.07},
                             .result = bench::ChangeClass::kWorse};
  bench::MetricChange unclear = slower;
  unclear.metric = "a<b";
  unclear.result = bench::ChangeClass::kInconclusive;
  return {.pairs = 20, .bit_equal = 20, .changes = {slower, unclear}};
}

TEST(ComparisonReport, StartsWithTheResult) {
  const std::string text = comparison_markdown({"old", "new"}, comparison());
  EXPECT_TRUE(text.starts_with("# new compared with old: worse\n")) << text;
  EXPECT_NE(text.find("+5.0 %"), std::string::npos);
  EXPECT_NE(text.find("+4.0 % to +6.0 %"), std::string::npos);
}

TEST(ComparisonReport, JunitReportsWorseAsFailureAndInconclusiveAsSkipped) {
  const std::string text = comparison_junit({"old", "new"}, comparison());
  EXPECT_NE(text.find("tests=\"3\" failures=\"1\" skipped=\"1\""), std::string::npos) << text;
  EXPECT_NE(text.find("classname=\"a&lt;b\""), std::string::npos) << text;
}

}  // namespace
}  // namespace stillpoint::report
