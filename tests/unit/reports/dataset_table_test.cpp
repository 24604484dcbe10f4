// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/result_tables.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reports/tables/paper_tables.h"

namespace stillpoint::report {
namespace {

bench::StoredRun run_on(const std::string& sequence, double ate) {
  bench::StoredRun run;
  run.key = sequence;
  run.identity = {.variant = "dynamic_vins_vo", .sequence = sequence};
  run.metrics = {{"ate_rmse_m", "compat:tum", "m", ate},
                 {"rpe_trans_rmse_m_per_s", "compat:tum", "m/s", ate},
                 {"rpe_rot_rmse_deg_per_s", "compat:tum", "deg/s", ate}};
  return run;
}

TEST(DatasetTable, KeepsSequencesWithoutDataOutOfTheMeans) {
  const std::vector<bench::StoredRun> runs{run_on("bonn_crowd", 0.02), run_on("bonn_crowd2", 0.04)};
  const DatasetTableLayout layout{.name = "bonn",
                                  .title = "Bonn",
                                  .sequences = {"bonn_crowd", "bonn_crowd2", "bonn_static"},
                                  .variants = {"dynamic_vins_vo"}};
  const ReportTable table = dataset_table(layout, runs, bench::load_published("bonn_ate"));
  ASSERT_EQ(table.rows.size(), 4U);
  EXPECT_EQ(table.columns.back().name, "dynamic_vins_vo");
  EXPECT_EQ(table.rows[2].label, "bonn_static");
  EXPECT_FALSE(table.rows[2].cells.back().number);
  EXPECT_NEAR(*table.rows[3].cells.back().number, 0.03, 1e-12);
  EXPECT_NE(table.notes.back().find("dynamic_vins_vo 2 of 3"), std::string::npos) << table.notes.back();
  // DynaSLAM, source A: crowd 0.016 under the name of the recording.
  EXPECT_EQ(table.columns.front().name, "DynaSLAM (RGB-D), A");
  EXPECT_EQ(table.rows[0].cells.front().number, 0.016);
}

TEST(DatasetTable, NeedsNoPublishedRows) {
  bench::PublishedTable none;
  none.metric = "ate_rmse_m";
  const ReportTable table =
      dataset_table({.name = "v", .title = "V", .sequences = {"a"}, .variants = {"vo"}}, {}, none);
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_FALSE(table.rows[1].cells[0].number);
}

TEST(PaperTable, ShowsRecordingsAndTheMeanOfThoseWithData) {
  const std::vector<bench::StoredRun> runs{run_on("tum_fr3_walking_xyz", 0.05),
                                           run_on("tum_fr3_walking_rpy", 0.07)};
  const ReportTable table = paper_table(PaperTable::kTable1, runs);
  ASSERT_EQ(table.rows.size(), 15U);               // 3 rows for each of 4 sequences and the mean
  EXPECT_EQ(table.rows[1].cells[9].number, 0.05);  // ours, ATE of the fourth system
  EXPECT_FALSE(table.rows[4].cells[9].number);     // walking_static
  EXPECT_EQ(table.rows[12].label, "mean of 2 of 4 sequences");
  EXPECT_NEAR(*table.rows[12].cells[9].number, 0.5 * (0.0486 + 0.0629), 1e-12);  // published
  EXPECT_NEAR(*table.rows[13].cells[9].number, 0.06, 1e-12);
}

TEST(PaperTable, NotesThatSequencesAreRenderedOnlyIfTheyAre) {
  const auto has_note = [](const std::vector<bench::StoredRun>& runs) {
    return std::ranges::any_of(paper_table(PaperTable::kTable1, runs).notes, [](const std::string& note) {
      return note.find("Rendered sequences") != std::string::npos;
    });
  };
  EXPECT_FALSE(has_note({run_on("tum_fr3_walking_xyz", 0.05)}));
  EXPECT_TRUE(has_note({run_on("walking_xyz", 0.05)}));
}

}  // namespace
}  // namespace stillpoint::report
