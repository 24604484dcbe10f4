// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/tidy_runs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace stillpoint::report {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

bench::StoredRun scored_run() {
  bench::StoredRun run;
  run.key = "8f18";
  run.identity = {.variant = "stillpoint", .sequence = "market", .build = "abc123", .seed = 3};
  run.started = "2026-01-31T12:00:00Z";
  run.metrics = {{"ate_rmse_m", "strict, rigid alignment", "m", 0.1 + 0.2}};
  return run;
}

TEST(TidyRuns, WritesARowPerRunAndMetricWithAllDigits) {
  const std::vector<std::string> lines = lines_of(tidy_text(std::vector{scored_run()}));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0], tidy_header());
  EXPECT_EQ(lines[2],
            "8f18,stillpoint,stillpoint,market,,,abc123,,2026-01-31T12:00:00Z,,sequential,accuracy,,3,1,,,ok,"
            "\"strict, rigid alignment\",ate_rmse_m,m,smaller,0.30000000000000004");
}

TEST(TidyRuns, EachRowHasTheColumnsOfTheHeader) {
  bench::StoredRun run = scored_run();
  run.metrics.clear();
  run.identity.axis = "imu.noise_scale";
  run.identity.axis_value = 1.5;
  run.costs = {{.module = "feature_tracking", .per = "call", .calls = 4, .mean_ms = 1.5}};
  const std::vector<std::string> lines = lines_of(tidy_text(std::vector{run}));
  ASSERT_EQ(lines.size(), 6U);
  for (const std::string& line : lines)
    EXPECT_EQ(std::ranges::count(line, ','), std::ranges::count(lines[0], ',')) << line;
  EXPECT_TRUE(lines[2].ends_with("imu.noise_scale,1.5,ok,per call,mean_ms/feature_tracking,ms,smaller,1.5"));
}

/// A table of metrics alone would not contain it.
TEST(TidyRuns, ContainsARunThatFailed) {
  bench::StoredRun run;
  run.outcome = bench::Outcome::kCrashed;
  const std::vector<std::string> lines = lines_of(tidy_text(std::vector{run}));
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_TRUE(lines[1].ends_with(",crashed,,succeeded,,larger,0")) << lines[1];
}

TEST(TidyRuns, WritesValuesThatAreNoNumbersAsStatisticsProgramsReadThem) {
  bench::StoredRun run = scored_run();
  run.metrics = {{"ate_rmse_m", "", "m", std::numeric_limits<double>::infinity()},
                 {"coverage", "", "", std::nan("")}};
  const std::vector<std::string> lines = lines_of(tidy_text(std::vector{run}));
  EXPECT_TRUE(lines[2].ends_with(",inf"));
  EXPECT_TRUE(lines[3].ends_with(",nan"));
}

}  // namespace
}  // namespace stillpoint::report
