// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text/comparison_report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace stillpoint::report {
namespace {

bench::Comparison comparison() {
  bench::MetricChange slower{.metric = "feature_tracking",
                             .subject = "vo",
                             .unit = "ms",
                             .base_median = 10.0,
                             .head_median = 10.5,
                             .change = {.count = 20,
                                        .median = 0.05,
                                        .p_value = 2e-6,
                                        .interval = eval::Interval{.low = 0.04, .high = 0.06}},
                             .adjusted_interval = eval::Interval{.low = 0.03, .high = 0.07},
                             .result = bench::ChangeClass::kWorse};
  bench::MetricChange unclear = slower;
  unclear.metric = "a<b";
  unclear.change = {.count = 3, .median = 0.2, .p_value = 0.25, .interval = std::nullopt};
  unclear.adjusted_interval.reset();
  unclear.changed = true;
  unclear.needed = 8;
  unclear.result = bench::ChangeClass::kInconclusive;
  return {.pairs = 20, .compared = 20, .bit_equal = 20, .changes = {slower, unclear}};
}

TEST(ComparisonReport, StartsWithResultAndCounts) {
  const std::string text = comparison_markdown({"old", "new"}, comparison());
  EXPECT_TRUE(text.starts_with("# new compared with old: worse\n")) << text;
  EXPECT_NE(text.find("20 pairs of runs: 20 compared (20 with bit-equal trajectories), 0 failed at base"),
            std::string::npos)
      << text;
}

TEST(ComparisonReport, PrintsIntervalAndPValueOrTheNumberOfPairs) {
  const std::string text = comparison_markdown({"old", "new"}, comparison());
  EXPECT_NE(text.find("+5.0 %"), std::string::npos) << text;
  EXPECT_NE(text.find("+4.0 % to +6.0 %"), std::string::npos) << text;
  EXPECT_NE(text.find("2e-06"), std::string::npos) << text;
  EXPECT_NE(text.find("- (n = 3)"), std::string::npos) << text;
  EXPECT_NE(text.find("changed, inconclusive"), std::string::npos) << text;
  const auto json = nlohmann::json::parse(comparison_json({"old", "new"}, comparison()));
  EXPECT_EQ(json["changes"][0]["n"], 20);
  EXPECT_EQ(json["changes"][0]["interval"][0], 0.04);
  EXPECT_TRUE(json["changes"][1]["interval"].is_null());
  EXPECT_EQ(json["changes"][1]["needed_pairs"], 8);
}

TEST(ComparisonReport, JunitReportsWorseAsFailureAndInconclusiveAsSkipped) {
  const std::string text = comparison_junit({"old", "new"}, comparison());
  EXPECT_NE(text.find("tests=\"7\" failures=\"1\" errors=\"0\" skipped=\"1\""), std::string::npos) << text;
  EXPECT_NE(text.find("classname=\"a&lt;b\""), std::string::npos) << text;
}

TEST(ComparisonReport, ListsWhatIsMissingFirst) {
  bench::Comparison lacking = comparison();
  lacking.changes.clear();
  lacking.missing = {{.what = "metric ate_rmse_m", .subject = "vo on a", .base = 20, .head = 7}};
  const std::string text = comparison_markdown({"old", "new"}, lacking);
  EXPECT_TRUE(text.starts_with("# new compared with old: missing in HEAD\n")) << text;
  EXPECT_NE(text.find("| metric ate_rmse_m | vo on a |"), std::string::npos) << text;
  EXPECT_NE(text.find("--allow-missing"), std::string::npos) << text;
  const std::string junit = comparison_junit({"old", "new"}, lacking);
  EXPECT_NE(junit.find("<failure message=\"missing in HEAD: metric ate"), std::string::npos) << junit;
  EXPECT_NE(junit.find("failures=\"1\""), std::string::npos) << junit;
  EXPECT_EQ(nlohmann::json::parse(comparison_json({"old", "new"}, lacking))["missing"][0]["head"], 7);
  lacking.missing_allowed = true;
  EXPECT_TRUE(comparison_markdown({"old", "new"}, lacking).starts_with("# new compared with old: same\n"));
}

TEST(ComparisonReport, JunitIsAnErrorIfNothingWasCompared) {
  const std::string none = comparison_junit({"old", "new"}, {});
  EXPECT_NE(none.find("errors=\"1\""), std::string::npos) << none;
  EXPECT_NE(none.find("<error message=\"0 pairs of runs: 0 compared"), std::string::npos) << none;
  const bench::Comparison failed{
      .pairs = 2, .base_failed = 2, .head_failed = 2, .first_failure = "vo on a, base: crashed"};
  const std::string text = comparison_junit({"old", "new"}, failed);
  EXPECT_NE(text.find("errors=\"1\""), std::string::npos) << text;
  EXPECT_NE(text.find("vo on a, base: crashed"), std::string::npos) << text;
  const std::string markdown = comparison_markdown({"old", "new"}, failed);
  EXPECT_TRUE(markdown.starts_with("# new compared with old: error\n")) << markdown;
  EXPECT_NE(markdown.find("First failure: vo on a, base: crashed."), std::string::npos) << markdown;
}

}  // namespace
}  // namespace stillpoint::report
