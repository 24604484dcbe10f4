// SPDX-License-Identifier: BSD-3-Clause
#include "reports/text/evaluation_report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/simulated/smooth_path.h"

namespace stillpoint::report {
namespace {

TEST(EvaluationJson, HasProtocolTextAndTheKeysOfResultFiles) {
  const Trajectory path = test::smooth_path(100, 0.1);
  const nlohmann::ordered_json json =
      evaluation_json(eval::evaluate("strict:se3", {path, path, eval::ProtocolOptions{}}));
  EXPECT_EQ(json.at("protocol"), "strict:se3");
  EXPECT_FALSE(json.at("text").get<std::string>().empty());
  EXPECT_EQ(json.at("pairs"), 100);
  EXPECT_NEAR(json.at("ate_rmse_m").get<double>(), 0.0, 1e-12);
  EXPECT_NEAR(json.at("rpe_trans_rmse_m_per_s").get<double>(), 0.0, 1e-12);
  EXPECT_NEAR(json.at("rpe_rot_rmse_deg_per_s").get<double>(), 0.0, 1e-6);
}

TEST(EvaluationJson, MetricsAreNullWithoutData) {
  const Trajectory path = test::smooth_path(100, 0.1);
  const nlohmann::ordered_json json =
      evaluation_json(eval::evaluate("compat:tum", {path, {}, eval::ProtocolOptions{}}));
  EXPECT_TRUE(json.at("ate_rmse_m").is_null());
  EXPECT_TRUE(json.at("rpe_trans_rmse_m_per_s").is_null());
}

TEST(EvaluationTable, ShowsNotAvailableWithoutData) {
  const Trajectory path = test::smooth_path(100, 0.1);
  EvaluatedRun run;
  run.name = "lost";
  run.evaluations.push_back(eval::evaluate("compat:tum", {path, {}, eval::ProtocolOptions{}}));
  const std::string csv = evaluation_table({run}, TableStyle::kCsv);
  EXPECT_NE(csv.find("lost,compat:tum,0,n/a,n/a,n/a,n/a,n/a,n/a,0,1 s,n/a\n"), std::string::npos) << csv;
}

TEST(ComparisonTable, EqualErrorsShareARank) {
  eval::Comparison comparison;
  const auto add = [&comparison](const std::string& name, std::optional<double> ate_m) {
    comparison.ranking.push_back({.name = name, .coverage = 1.0, .common_ate_rmse_m = ate_m});
  };
  add("a", 0.01);
  add("b", 0.01);
  add("c", 0.02);
  add("d", std::nullopt);  // too few common poses
  comparison.ranking.push_back({.name = "e", .failed = true});
  const std::string csv = comparison_table(comparison, TableStyle::kCsv);
  for (const char* row : {"\n1,a,", "\n1,b,", "\n3,c,", "\nn/a,d,", "\nfailed,e,"})
    EXPECT_NE(csv.find(row), std::string::npos) << csv;
}

}  // namespace
}  // namespace stillpoint::report
