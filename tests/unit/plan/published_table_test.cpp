// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/published_table.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

double value_of(const std::string& table, const std::string& system, const std::string& source,
                const std::string& column) {
  for (const PublishedRow& row : load_published(table).rows) {
    if (row.system == system && row.source == source) return row.values.at(column);
  }
  return -1.0;
}

TEST(PublishedTable, EveryEmbeddedTableHasComparabilityNotes) {
  EXPECT_GE(published_names().size(), 14u);
  for (const std::string& name : published_names()) {
    const PublishedTable table = load_published(name);
    EXPECT_EQ(table.name, name);
    EXPECT_FALSE(table.comparability.empty()) << name;
    EXPECT_FALSE(table.alignment.empty()) << name;
    EXPECT_FALSE(table.rows.empty()) << name;
    for (const PublishedRow& row : table.rows) EXPECT_FALSE(row.input.empty()) << row.system;
  }
}

// From the paper's Tables I, II and III.
TEST(PublishedTable, ContainsTheNumbersOfThePaper) {
  EXPECT_EQ(value_of("tum_fr3_ate", "Dynamic-VINS (VO)", "paper", "walking_xyz"), 0.0486);
  EXPECT_EQ(value_of("tum_fr3_rpe_rot", "Dynamic-VINS (VO)", "paper", "walking_halfsphere"), 5.2116);
  EXPECT_EQ(value_of("tum_fr3_ablation_ate", "Dynamic-VINS wo_mcc", "paper", "walking_rpy"), 0.1236);
  EXPECT_EQ(value_of("runtime_market", "Dynamic-VINS on Jetson AGX Xavier", "paper", "tracking_thread"),
            5.5416);
}

TEST(PublishedTable, SeparatesSim3AlignedFromRigidlyAlignedNumbers) {
  const PublishedTable table = load_published("tum_fr3_ate_sim3");
  EXPECT_NE(table.alignment.find("scale"), std::string::npos);
  const PublishedTable rigid = load_published("tum_fr3_ate");
  EXPECT_TRUE(std::none_of(rigid.rows.begin(), rigid.rows.end(),
                           [](const PublishedRow& row) { return row.system == "WildGS-SLAM"; }));
}

TEST(PublishedTable, NamesTheInputOfARow) {
  const TemporaryFolder folder;
  const std::string head = "title = \"t\"\nmetric = \"m\"\nunit = \"\"\nalignment = \"rigid\"\n";
  const std::string rows =
      "sources = {A = \"a\"}\n[[row]]\nsystem = \"s\"\nsource = \"A\"\nvalues = {a = 1}\n"
      "[[row]]\nsystem = \"t\"\nsource = \"A\"\ninput = \"RGB-D, IMU\"\nvalues = {a = 1}\n";
  const PublishedTable table =
      load_published(folder.write("p.toml", head + "input = \"stereo\"\n" + rows).string());
  EXPECT_EQ(system_label(table.rows[0]), "s (stereo)");
  EXPECT_EQ(system_label(table.rows[1]), "t (RGB-D, IMU)");
  const auto without = folder.write("q.toml", head + rows);
  expect_input_error([&] { static_cast<void>(load_published(without.string())); },
                     {"q.toml:6: requires a string \"input\""});
}

TEST(PublishedTable, RejectsANumberWithoutItsSource) {
  const TemporaryFolder folder;
  const std::string head =
      "title = \"t\"\nmetric = \"m\"\nunit = \"\"\nalignment = \"rigid\"\ninput = \"RGB-D\"\n";
  const auto file =
      folder.write("p.toml", head + "[[row]]\nsystem = \"s\"\nsource = \"A\"\nvalues = {a = 1}\n");
  expect_input_error([&] { static_cast<void>(load_published(file.string())); }, {"p.toml:6: source \"A\""});
  const auto text =
      folder.write("q.toml", head + "[[row]]\nsystem = \"s\"\nsource = \"A\"\nvalues = {a = \"1\"}\n");
  expect_input_error([&] { static_cast<void>(load_published(text.string())); },
                     {"q.toml:9: \"a\" must be a number"});
}

TEST(PublishedTable, RejectsWhatItWouldShowWronglyOrLeaveOut) {
  const TemporaryFolder folder;
  const auto fault = [&](const std::string& unit, const std::string& rest,
                         const std::vector<std::string>& parts) {
    const std::string head = "title = \"t\"\nmetric = \"ate_rmse_m\"\nunit = \"" + unit +
                             "\"\nalignment = \"rigid\"\ninput = \"RGB-D\"\nsources = {A = \"a\"}\n";
    const auto file = folder.write("p.toml", head + rest);
    expect_input_error([&] { static_cast<void>(load_published(file.string())); }, parts);
  };
  const std::string row = "[[row]]\nsystem = \"s\"\nsource = \"A\"\n";
  fault("cm", row + "values = {a = 1}\n",
        {"p.toml:3: \"unit\" is \"cm\"", "ate_rmse_m is measured in \"m\""});
  fault("m", "[[rows]]\nsystem = \"s\"\n", {"p.toml:7: unknown key \"rows\"", "\"row\"?"});
  fault("m", "[row]\nsystem = \"s\"\n", {"p.toml:7: \"row\" must be a list of tables: [[row]]"});
  fault("m", "comparability = \"x\"\n", {"p.toml:7: \"comparability\" must be a list"});
  fault("m", row + "values = {a = 1}\nnotes = \"x\"\n", {"p.toml:11: unknown key \"notes\"", "\"note\"?"});
  fault("m", row + "values = {a = nan}\n", {"p.toml:10: \"a\" is nan; leave a value out"});
  fault("m", row + "values = {a = 1, b = -2}\n", {"p.toml:10: \"b\" is -2"});
}

}  // namespace
}  // namespace stillpoint::bench
