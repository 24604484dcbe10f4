// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/metrics.h"

#include <gtest/gtest.h>

#include <set>

#include "core/base/error.h"
#include "core/base/module_timings.h"

namespace stillpoint::bench {
namespace {

TEST(Metrics, HaveUniqueIdsLabelsAndDescriptions) {
  std::set<std::string_view> ids;
  for (const MetricDescriptor& metric : all_metrics()) {
    EXPECT_TRUE(ids.insert(metric.id).second) << metric.id;
    EXPECT_FALSE(metric.label.empty()) << metric.id;
    EXPECT_FALSE(metric.description.empty()) << metric.id;
    EXPECT_TRUE(metric.title.empty() || metric.value != nullptr) << metric.id;
  }
}

TEST(Metrics, HaveADirectionIfTheyAreCompared) {
  for (const MetricDescriptor& metric : all_metrics())
    EXPECT_TRUE(!metric.gate || metric.direction != MetricDirection::kNone) << metric.id;
}

TEST(Metrics, OfPartsThatWereNotMeasuredAreAbsent) {
  EXPECT_TRUE(measured_metrics({}).empty());
  const std::vector<Metric> process =
      measured_metrics({.process = ProcessCost{.wall_s = 2.0, .cpu_s = 3.0, .peak_memory_bytes = 5 << 20}});
  ASSERT_EQ(process.size(), 3u);
  EXPECT_EQ(process[0].name, "process_cpu_s");
  EXPECT_EQ(process[0].value, 3.0);
  EXPECT_EQ(process[2].unit, "MB");
  EXPECT_EQ(process[2].value, 5.0);
}

TEST(Metrics, QuietMeansLessThanFivePercentOtherLoad) {
  EXPECT_EQ(measured_metrics({.other_load = 0.04}).back().value, 1.0);
  EXPECT_EQ(measured_metrics({.other_load = 0.05}).back().value, 0.0);
}

TEST(Metrics, OfAllStagesAreTheSumOfInstructions) {
  const std::vector<Metric> counts =
      measured_metrics({.instructions = {{"tracking", 5}, {"optimization", 7}}});
  ASSERT_EQ(counts.size(), 3u);  // no detection
  EXPECT_EQ(counts[0].value, 12.0);
  EXPECT_EQ(counts[2].name, "instructions_optimization");
}

TEST(Metrics, OfProtocolsShareTheDescription) {
  EXPECT_EQ(tooltip_of("strict:se3/ate_rmse_m"), tooltip_of("ate_rmse_m"));
  EXPECT_TRUE(tooltip_of("ate_rmse_m").ends_with("[m]; smaller is better"));
  EXPECT_EQ(gated_metric("strict:se3/ate_rmse_m"), nullptr);
  EXPECT_NE(gated_metric(without_protocol("strict:se3/ate_rmse_m")), nullptr);
}

TEST(Metrics, ErrorsAreNotNegativeAndFractionsAtMost1) {
  EXPECT_EQ(impossibility({.name = "ate_rmse_m", .value = -0.1}), "negative");
  EXPECT_EQ(impossibility({.name = "ate_rmse_m", .value = 1.7}), "");
  for (const char* name : {"coverage", "correct_rate", "false_confidence", "strict:se3/correct_rate"}) {
    EXPECT_EQ(impossibility({.name = name, .value = 1.7}), "above 1") << name;
    EXPECT_EQ(impossibility({.name = name, .value = 1.0 + 1e-15}), "") << name;  // rounded
  }
  EXPECT_EQ(impossibility({.name = "frames", .value = -1.0}), "");  // not compared
}

TEST(Metrics, ModulesHaveTooltipsAndUnknownNamesHaveNone) {
  for (std::size_t i = 0; i < kModuleCount; ++i)
    EXPECT_FALSE(tooltip_of(module_name(static_cast<Module>(i))).empty());
  EXPECT_EQ(tooltip_of("no_such_metric"), "");
}

TEST(Outcome, IsReadFromNamesAndFromStatusesOfResultFiles) {
  for (const Outcome outcome : {Outcome::kOk, Outcome::kLost, Outcome::kInterrupted, Outcome::kCrashed,
                                Outcome::kTimedOut, Outcome::kOutOfMemory, Outcome::kBadData}) {
    EXPECT_EQ(outcome_of(outcome_name(outcome)), outcome);
    EXPECT_EQ(outcome_of(status_name(outcome)), outcome);
  }
  EXPECT_EQ(status_name(Outcome::kLost), "failed");  // as in the result files of all versions
  EXPECT_THROW(static_cast<void>(outcome_of("fine")), InputError);
}

}  // namespace
}  // namespace stillpoint::bench
