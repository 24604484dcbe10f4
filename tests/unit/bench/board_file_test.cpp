// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/board_file.h"

#include <gtest/gtest.h>

#include "bench/config/toml_source.h"
#include "bench/systems/published_table.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

TEST(BoardFile, EveryEmbeddedOneCanBeRead) {
  for (const std::string& name : embedded_names(TomlFamily::kBoard))
    EXPECT_FALSE(load_board(name).title.empty());
}

/// The row of Table III.
std::map<std::string, double> published(const std::string& system) {
  for (const PublishedRow& row : load_published("runtime_market").rows) {
    if (row.system == system) return row.values;
  }
  return {};
}

TEST(BoardFile, CostsOfThePapersBoardsAreThosePublished) {
  const std::pair<const char*, const char*> boards[] = {
      {"jetson_agx_xavier", "Dynamic-VINS on Jetson AGX Xavier"},
      {"atlas_200", "Dynamic-VINS on Atlas200 DK"}};
  for (const auto& [board, system] : boards) {
    std::map<std::string, double> row = published(system);
    const BoardModel model = board_model(load_board(board));
    EXPECT_TRUE(model.is_deterministic());
    EXPECT_EQ(model.tracking.fixed_ms, row["tracking_thread"]) << board;
    EXPECT_EQ(model.detection.fixed_ms, row["object_detection"]) << board;
    EXPECT_EQ(model.optimization.fixed_ms, row["optimization_thread"]) << board;
  }
}

TEST(BoardFile, ScalesWhatHasNoFixedCost) {
  const TemporaryFolder folder;
  const BoardModel model = board_model(
      load_board(folder.write("mine.toml", "cores = 4\n[factor]\ntracking_thread = 2.5\n").string()));
  EXPECT_EQ(model.cores, 4);
  EXPECT_FALSE(model.is_deterministic());
  EXPECT_FALSE(model.tracking.fixed_ms);
  EXPECT_EQ(model.tracking.factor, 2.5);
  EXPECT_EQ(model.optimization.factor, 1.0);
}

TEST(BoardFile, RefusesWhatIsNoBoard) {
  const TemporaryFolder folder;
  expect_input_error([] { static_cast<void>(load_board("jetson_agx_xavie")); },
                     {"board \"jetson_agx_xavie\"", "did you mean \"jetson_agx_xavier\"?"});
  expect_input_error([&] { static_cast<void>(load_board(folder.write("a.toml", "core = 4\n").string())); },
                     {"a.toml:1", "unknown key \"core\"", "\"cores\""});
  expect_input_error(
      [&] {
        static_cast<void>(load_board(folder.write("b.toml", "[factor]\ntracking_thread = -0.5\n").string()));
      },
      {"b.toml", "negative factor"});
}

}  // namespace
}  // namespace stillpoint
