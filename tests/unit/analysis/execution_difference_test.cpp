// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/run_statistics.h"

#include <gtest/gtest.h>

#include "bench/store/store_writer.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

constexpr const char* kHead = "frame,tracking,dynamic,optimization\n";

/// A store with the run of each sequence: its frames.csv and its trajectory.
struct Execution {
  std::string sequence;
  std::string frames;
  std::string trajectory;
};
Store store_of(const TemporaryFolder& folder, const std::string& name, const std::vector<Execution>& runs,
               const std::string& cores = "") {
  const std::filesystem::path file = folder.path() / name;
  StoreWriter writer(file);
  for (const Execution& run : runs) {
    const RunIdentity identity{.variant = "vo", .sequence = run.sequence, .cores = cores};
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity, {.metrics = {{"ate_rmse_m", "", "m", 0.5}},
                             .attachments = {{"trajectory", run.trajectory}, {"frames", run.frames}}});
  }
  return Store(file);
}

TEST(StageDifferences, NameTheFirstFrameOfEachStage) {
  const std::string head = kHead;
  const std::vector<StageDifference> stages =
      stage_differences(head + "0,a,b,c\n3,d,e,f\n6,g,h,i\n", head + "0,a,b,x\n3,d,y,z\n6,g,h,i\n");
  ASSERT_EQ(stages.size(), 3u);
  EXPECT_EQ(stages[0].stage, "tracking");
  EXPECT_FALSE(stages[0].frame);
  EXPECT_EQ(stages[1].frame, 3);
  EXPECT_EQ(stages[2].frame, 0);
  EXPECT_TRUE(stage_differences(head, "").empty());
}

TEST(ExecutionDifferences, CompareTheRunsThatBothStoresContain) {
  const TemporaryFolder folder;
  const std::string frames = std::string(kHead) + "0,a,b,c\n1,d,e,f\n";
  const std::string poses = "0.0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n";
  const Store here =
      store_of(folder, "here.sqlite", {{"a", frames, poses}, {"b", frames, poses}, {"c", frames, poses}});
  const Store there =
      store_of(folder, "there.sqlite",
               {{"b", std::string(kHead) + "0,a,b,c\n1,d,e,x\n", "0.0 0 0 0 0 0 0 1\n0.1 1 0 0.25 1 0 0 0\n"},
                {"a", frames, poses}},
               "0,1");
  const std::vector<ExecutionDifference> rows = execution_differences(here, here.runs(), there);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].label, "a vo seed 1");
  EXPECT_TRUE(rows[0].equal_trajectories);
  EXPECT_EQ(rows[0].largest_m, 0.0);
  EXPECT_EQ(rows[0].frames, 2u);
  EXPECT_EQ(rows[1].label, "b vo seed 1");
  EXPECT_FALSE(rows[1].equal_trajectories);
  EXPECT_NEAR(rows[1].largest_m, 0.25, 1e-12);
  EXPECT_NEAR(rows[1].largest_rad, 3.14159265, 1e-6);
  EXPECT_EQ(rows[1].stages.back().frame, 1);
  EXPECT_EQ(rows[1].ate_m, 0.5);
  EXPECT_EQ(rows[1].other_ate_m, 0.5);
}

}  // namespace
}  // namespace stillpoint::bench
