// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint stats`: selection of runs, number of values, and missing intervals.
#include <cmath>
#include <fstream>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/store/store_writer.h"
#include "tests/support/program.h"
#include "tests/support/rejection.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

/// Variants "vo" and "wo" with an error of 0.01 m and 0.02 m, and `seeds` runs each, with two builds; the
/// older build has ten times the error.
class StatsCommand : public testing::Test {
 protected:
  void fill(int seeds,
            const std::string& plan_text = "ablation_base = \"vo\"\nvariants = [\"vo\", \"wo\"]\n") {
    bench::StoreWriter writer(file_);
    bench::StoredPlan plan{.name = "p", .title = "", .text = plan_text, .run_keys = {}};
    for (const std::string build : {"older", "newer"}) {
      plan.run_keys.clear();
      for (const std::string variant : {"vo", "wo"}) {
        for (int seed = 1; seed <= seeds; ++seed)
          plan.run_keys.push_back(add_run(
              writer,
              {.variant = variant, .sequence = "a", .config_hash = variant, .build = build, .seed = seed}));
      }
    }
    writer.record_plan(plan);
  }

  static std::string add_run(bench::StoreWriter& writer, const bench::RunIdentity& identity) {
    static_cast<void>(writer.acquire(identity));
    const double ate = (identity.variant == "vo" ? 0.01 : 0.02) * (identity.build == "older" ? 10.0 : 1.0) +
                       1e-4 * static_cast<double>(identity.seed);
    writer.finish(identity, {.metrics = {{"ate_rmse_m", "", "m", ate}, {"coverage", "", "", 1.0}}});
    return bench::run_key(identity);
  }

  [[nodiscard]] ProgramResult stats(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "stats");
    arguments.insert(arguments.end(), {"--store", file_.string()});
    return run_program(arguments);
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "store.sqlite";
};

TEST_F(StatsCommand, SummarizesTheNewestBuildAndSaysWhatWasLeftOut) {
  fill(3);
  const ProgramResult result = stats({"summary"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  // Seeds 1 to 3: 0.0101, 0.0102, 0.0103.
  EXPECT_NE(result.out.find("0.0102"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("0.1002"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("- (n = 3)"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("the smallest two-sided p of n = 3 is 0.25"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("build: newer"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("Left out, other builds: older (6 runs)"), std::string::npos) << result.out;
}

TEST_F(StatsCommand, RunsThatAllFailedAreCounted) {
  {
    bench::StoreWriter writer(file_);
    const bench::RunIdentity identity{.variant = "vo", .sequence = "a"};
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity,
                  {.outcome = bench::Outcome::kCrashed, .metrics = {{"process_wall_s", "", "s", 1.0}}});
  }
  const ProgramResult result = stats({"summary"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("| a        | vo      |       | 1    | 1      | 0 "), std::string::npos)
      << result.out;
}

TEST_F(StatsCommand, NamesRelativeErrorsOfFewPairs) {
  {
    bench::StoreWriter writer(file_);
    for (const std::string variant : {"many", "few"}) {
      const bench::RunIdentity identity{.variant = variant, .sequence = "a", .config_hash = variant};
      static_cast<void>(writer.acquire(identity));
      writer.finish(identity, {.metrics = {{"rpe_trans_rmse_m_per_s", "", "m/s", 0.01},
                                           {"rpe_pairs", "", "", variant == "few" ? 3.0 : 300.0}}});
    }
  }
  const std::string out = stats({"summary", "--metric", "rpe_trans_rmse_m_per_s"}).out;
  EXPECT_NE(out.find("a, few: RPE of only 3 pairs of poses: not ranked."), std::string::npos) << out;
  EXPECT_EQ(out.find("a, many: RPE"), std::string::npos) << out;
}

TEST_F(StatsCommand, ShowsAllBuildsInSeparateRows) {
  fill(6);
  const ProgramResult result = stats({"summary", "--build", "all", "--format", "csv"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(
      result.out.substr(0, result.out.find('\n')),
      "build,machine,mode,sequence,variant,axis,axis_value,metric,unit,runs,failed,without_value,copies,n,"
      "median,median_low,median_high,quartile_low,quartile_high,worst,modes,doubt");
  EXPECT_NE(result.out.find(",0.0101,0.0106,"), std::string::npos) << result.out;  // all six values
  EXPECT_NE(result.out.find(",0.2001,0.2006,"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("Left out"), std::string::npos);
  EXPECT_NE(stats({"summary", "--build", "old"}).out.find("build: older"), std::string::npos);
  expect_rejected(stats({"summary", "--build", "x"}), {"--build", "\"x\"", "newer, older"});
}

TEST_F(StatsCommand, AblationHasTheBaseOfThePlan) {
  fill(6);
  const ProgramResult result = stats({"ablation"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  // Differences of 0.01 in all six pairs.
  EXPECT_NE(
      result.out.find("| vo   | wo      | (all)    | 6   | 0            | 0.01       | 0.01 to 0.01  |"),
      std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("build: newer"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("build: older"), std::string::npos) << result.out;
  const std::string reversed = stats({"ablation", "--base", "wo"}).out;
  EXPECT_NE(reversed.find("| -0.01 to -0.01 | -1.00"), std::string::npos) << reversed;
}

TEST_F(StatsCommand, AblationMarksTheRowOverAllOfOneSequence) {
  fill(6);
  const std::string mark = "pairs of one sequence";
  const std::string note = "no statement on other sequences";
  const std::string table = stats({"ablation"}).out;
  const std::size_t row = table.find("(all)");
  EXPECT_LT(table.find(mark, row), table.find('\n', row)) << table;
  EXPECT_NE(table.find(note), std::string::npos) << table;
  EXPECT_NE(stats({"ablation", "--format", "json"}).out.find(note), std::string::npos);
  EXPECT_NE(stats({"ablation", "--format", "csv"}).err.find(note), std::string::npos);
  bench::StoreWriter writer(file_);
  bench::StoredPlan plan{.name = "q", .title = "", .text = "ablation_base = \"vo\"\n", .run_keys = {}};
  for (const std::string sequence : {"b", "c"}) {
    for (const std::string variant : {"vo", "wo"})
      plan.run_keys.push_back(add_run(
          writer, {.variant = variant, .sequence = sequence, .config_hash = variant, .build = "newer"}));
  }
  writer.record_plan(plan);
  EXPECT_EQ(stats({"ablation", "--plan", "q"}).out.find(mark), std::string::npos);
}

TEST_F(StatsCommand, TablesForProgramsHaveNumbers) {
  fill(6);
  const ProgramResult result = stats({"ablation", "--format", "json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json table = nlohmann::json::parse(result.out);
  EXPECT_EQ(table.at("kind"), "stats_ablation");
  EXPECT_EQ(table.at("schema"), 2);
  const nlohmann::json& row = table.at("rows").at(0);
  EXPECT_EQ(row.at("doubt"), nullptr);
  EXPECT_EQ(row.at("build"), "newer");
  EXPECT_EQ(row.at("variant"), "wo");
  EXPECT_EQ(row.at("unit"), "m");
  EXPECT_EQ(row.at("n"), 6);
  EXPECT_EQ(row.at("p"), 0.03125);  // 2 / 2^6: all six signs are equal
  EXPECT_NEAR(row.at("difference_low"), 0.01, 1e-12);
  EXPECT_NEAR(row.at("difference_high"), 0.01, 1e-12);
  // 0.0201 / 0.0101 to 0.0206 / 0.0106
  EXPECT_NEAR(row.at("relative_high"), 0.0201 / 0.0101 - 1.0, 1e-12);
  EXPECT_NEAR(row.at("relative_low"), 0.0206 / 0.0106 - 1.0, 1e-12);
  EXPECT_FALSE(table.at("notes").empty());
}

TEST_F(StatsCommand, AnIntervalThatTooFewRunsSupportIsNull) {
  fill(3);
  const nlohmann::json rows = nlohmann::json::parse(stats({"--format", "json"}).out).at("rows");
  EXPECT_EQ(rows.at(0).at("median"), 0.0102);
  EXPECT_TRUE(rows.at(0).at("median_low").is_null());
}

TEST_F(StatsCommand, RejectsAnUnknownFormat) {
  fill(1);
  expect_rejected(stats({"--format", "yaml"}), {"--format", "\"yaml\"", "table, csv, json"});
}

TEST_F(StatsCommand, AblationWithoutABaseListsTheVariants) {
  fill(2, "variants = [\"vo\", \"wo\"]\n");
  expect_rejected(stats({"ablation"}), {"--base", "ablation_base", "vo, wo"});
  expect_rejected(stats({"ablation", "--base", "full"}), {"--base", "\"full\"", "vo, wo"});
}

TEST_F(StatsCommand, FindsTheRunsOfAFaultPlanFileByItsName) {
  const std::string text =
      "variants = [\"vo\"]\nfaults = [\"blank:start=1,duration=1\"]\nexpected = [\"survive\"]\n"
      "[rendered]\nsequences = [\"market\"]\n";
  std::ofstream(folder_.path() / "my_faults.toml") << text;
  bench::StoreWriter writer(file_);
  const bench::RunIdentity identity{.variant = "vo", .sequence = "market + blank:start=1,duration=1"};
  static_cast<void>(writer.acquire(identity));
  writer.finish(identity,
                {.metrics = {{"false_confidence", "", "", 0.0}, {"error_after_recovery_m", "", "m", 0.005}}});
  writer.record_plan(
      {.name = "my_faults", .title = "", .text = text, .run_keys = {bench::run_key(identity)}});
  const ProgramResult result = stats({"faults", "--plan", (folder_.path() / "my_faults.toml").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("survive, 0.005 m, 0.0 %"), std::string::npos) << result.out;
  const std::string json =
      stats({"faults", "--plan", (folder_.path() / "my_faults.toml").string(), "--format", "json"}).out;
  const nlohmann::json row = nlohmann::json::parse(json).at("rows").at(0);
  EXPECT_EQ(row.at("result"), "survive");
  EXPECT_EQ(row.at("as_expected"), true);
  EXPECT_EQ(row.at("error_after_recovery_m"), 0.005);
  EXPECT_TRUE(row.at("time_to_detect_s").is_null());
}

TEST_F(StatsCommand, AStoreWithoutAPlanOfFaultsIsAnErrorWithARemedy) {
  fill(1);
  for (const std::string name : {"faults", "imperfections"})
    expect_rejected(stats({name}), {"store.sqlite", "no plan \"" + name + "\"", "stillpoint bench " + name,
                                    "--plan", "contains: p"});
  expect_rejected(stats({"faults", "--plan", "p"}), {"--plan", "file of the plan \"p\"", "p.toml"});
  const std::string plan = (folder_.path() / "p.toml").string();
  std::ofstream(plan) << "variants = [\"vo\"]\n[rendered]\nsequences = [\"market\"]\n";
  expect_rejected(stats({"faults", "--plan", plan}), {"p.toml", "no key \"expected\"", "\"survive\" or"});
}

TEST_F(StatsCommand, FaultsOfRecordedSequencesHaveRows) {
  const std::string text =
      "faults = [\"none\", \"blank:start=1,duration=1\"]\nexpected = [\"survive\", \"survive\"]\n"
      "[recorded]\nsequences = [\"*\"]\nvariants = [\"vo\"]\n";
  const std::string plan = (folder_.path() / "recordings.toml").string();
  std::ofstream(plan) << text;
  bench::StoreWriter writer(file_);
  bench::StoredPlan stored{.name = "recordings", .title = "", .text = text, .run_keys = {}};
  const auto add = [&](const std::string& sequence) {
    const bench::RunIdentity identity{.variant = "vo", .sequence = sequence};
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity, {.metrics = {{"false_confidence", "", "", 0.3}}});
    stored.run_keys.push_back(bench::run_key(identity));
  };
  add("desk");
  writer.record_plan(stored);
  expect_rejected(stats({"faults", "--plan", plan}), {"store.sqlite", "no run with a fault", "bench"});
  add("desk + blank:start=1,duration=1");
  writer.record_plan(stored);
  const ProgramResult result = stats({"faults", "--plan", plan});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_NE(result.out.find("| desk     | blank:start=1,duration=1 | survive  | wrong, -, 30.0 % (!) |"),
            std::string::npos)
      << result.out;
}

TEST_F(StatsCommand, ImperfectionsAreGeometricMeansOverSequences) {
  bench::StoreWriter writer(file_);
  bench::StoredPlan plan{.name = "rigs", .title = "", .text = "variants = [\"vo\"]\n", .run_keys = {}};
  const auto add = [&](const std::string& sequence, double ate_m) {
    const bench::RunIdentity identity{.variant = "vo", .sequence = sequence};
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity,
                  {.metrics = {{"ate_rmse_m", "", "m", ate_m}, {"false_confidence", "", "", 0.03}}});
    plan.run_keys.push_back(bench::run_key(identity));
  };
  add("a", 0.01);
  add("a + rig:seed=1", 0.02);
  add("b", 0.04);
  add("b + rig:seed=1", 0.16);
  for (const auto& [sequence, outcome] : {std::pair{"a + rig:seed=2", bench::Outcome::kOk},
                                          std::pair{"b + rig:seed=2", bench::Outcome::kLost}}) {
    const bench::RunIdentity lost{.variant = "vo", .sequence = sequence};
    static_cast<void>(writer.acquire(lost));
    writer.finish(lost,
                  {.outcome = outcome, .metrics = {{"ate_rmse_m", "", "m", 1.0}, {"coverage", "", "", 0.4}}});
    plan.run_keys.push_back(bench::run_key(lost));
  }
  writer.record_plan(plan);
  // sqrt(0.02 * 0.16) = 0.056569, sqrt(2 * 4) = 2.8284
  const std::string table = stats({"imperfections", "--plan", "rigs"}).out;
  EXPECT_NE(table.find("| 0.056569 | 2.8284 | 0.16        | 3.00 %"), std::string::npos) << table;
  const nlohmann::json rows =
      nlohmann::json::parse(stats({"imperfections", "--plan", "rigs", "--format", "json"}).out).at("rows");
  const nlohmann::json& all = rows.back();
  EXPECT_EQ(all.at("fault"), "(all)");
  EXPECT_EQ(all.at("runs"), 4);
  EXPECT_EQ(all.at("lost"), 2);
  EXPECT_NEAR(all.at("ate_rmse_m"), std::sqrt(0.02 * 0.16), 1e-12);
  EXPECT_NEAR(all.at("ate_ratio"), std::sqrt(8.0), 1e-12);
  EXPECT_EQ(all.at("worst_ate_rmse_m"), 0.16);
  EXPECT_NEAR(all.at("false_confidence"), 0.03, 1e-15);
}

// They were pooled, and compared with undisturbed runs at another sweep point.
TEST_F(StatsCommand, ImperfectionsAtSweepPointsHaveRowsOfTheirOwn) {
  bench::StoreWriter writer(file_);
  bench::StoredPlan plan{.name = "rigs", .title = "", .text = "variants = [\"vo\"]\n", .run_keys = {}};
  const auto add = [&](const std::string& sequence, double value, double ate_m) {
    const bench::RunIdentity identity{
        .variant = "vo", .sequence = sequence, .axis = "frontend.max_features", .axis_value = value};
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity, {.metrics = {{"ate_rmse_m", "", "m", ate_m}}});
    plan.run_keys.push_back(bench::run_key(identity));
  };
  add("a", 50, 0.01);
  add("a", 100, 0.05);
  add("a + jpeg", 50, 0.02);
  add("a + jpeg", 100, 0.05);
  writer.record_plan(plan);
  const std::string table = stats({"imperfections", "--plan", "rigs"}).out;
  EXPECT_NE(table.find("| jpeg   | vo (frontend.max_features = 50)  | 1    | 0    | 0.02  | 2 "),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("| jpeg   | vo (frontend.max_features = 100) | 1    | 0    | 0.05  | 1 "),
            std::string::npos)
      << table;
}

// The logarithm of 0 made the geometric mean of all runs 0.
TEST_F(StatsCommand, ImperfectionsHaveNoGeometricMeanOfAnErrorOf0) {
  bench::StoreWriter writer(file_);
  bench::StoredPlan plan{.name = "rigs", .title = "", .text = "variants = [\"vo\"]\n", .run_keys = {}};
  for (const auto& [sequence, ate_m] :
       {std::pair{"a", 0.01}, {"a + rig:seed=1", 0.0}, {"b", 0.0}, {"b + rig:seed=2", 0.02}}) {
    const bench::RunIdentity identity{.variant = "vo", .sequence = sequence};
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity, {.metrics = {{"ate_rmse_m", "", "m", ate_m}}});
    plan.run_keys.push_back(bench::run_key(identity));
  }
  writer.record_plan(plan);
  const nlohmann::json json =
      nlohmann::json::parse(stats({"imperfections", "--plan", "rigs", "--format", "json"}).out);
  for (const nlohmann::json& row : json.at("rows")) {
    const bool is_positive = row.at("fault") == "rig:seed=2";
    EXPECT_EQ(row.at("ate_rmse_m").is_null(), !is_positive) << row;
    EXPECT_TRUE(row.at("ate_ratio").is_null()) << row;  // relative to an ATE of 0, or 0 itself
  }
  EXPECT_NE(json.at("notes").dump().find("a + rig:seed=1, vo: an ATE of 0"), std::string::npos) << json;
}

TEST_F(StatsCommand, NotesNameTheMachineIfThereAreSeveral) {
  bench::StoreWriter writer(file_);
  for (const std::string machine : {"A", "B"}) {
    for (int seed = 1; seed <= 2; ++seed) {
      bench::RunIdentity identity{
          .variant = "vo", .sequence = "a", .sequence_id = "a", .build = "b", .seed = seed};
      identity.repetition = machine == "A" ? 1 : 2;
      static_cast<void>(writer.acquire(identity));
      writer.finish(identity, {.metrics = {{"ate_rmse_m", "", "m", 0.1 * std::pow(seed, 3)}},
                               .manifest = R"({"host": {"cpu": ")" + machine + R"(", "logical_cpus": 2}})"});
    }
  }
  const std::string table = stats({"summary"}).out;
  for (const std::string machine : {"A", "B"})
    EXPECT_NE(table.find("machine " + machine + ", 2 processors: a, vo: "), std::string::npos) << table;
}

// A lost run has the error of the part that it covers, which is no measure for others.
TEST_F(StatsCommand, ImperfectionsAreNotRelativeToALostRun) {
  bench::StoreWriter writer(file_);
  bench::StoredPlan plan{.name = "rigs", .title = "", .text = "variants = [\"vo\"]\n", .run_keys = {}};
  for (const auto& [sequence, coverage, ate_m] : {std::tuple{"a", 0.1, 0.001},
                                                  {"a + rig:seed=1", 1.0, 0.02},
                                                  {"b", 1.0, 0.01},
                                                  {"b + rig:seed=1", 1.0, 0.02}}) {
    const bench::RunIdentity identity{.variant = "vo", .sequence = sequence};
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity, {.metrics = {{"ate_rmse_m", "", "m", ate_m}, {"coverage", "", "", coverage}}});
    plan.run_keys.push_back(bench::run_key(identity));
  }
  writer.record_plan(plan);
  const nlohmann::json rows =
      nlohmann::json::parse(stats({"imperfections", "--plan", "rigs", "--format", "json"}).out).at("rows");
  EXPECT_NEAR(rows.back().at("ate_ratio"), 2.0, 1e-12);
}

TEST_F(StatsCommand, FaultTotalsAreThoseOfTheRunsThatEnded) {
  const std::string text =
      "variants = [\"vo\"]\nfaults = [\"blank:start=1,duration=1\"]\nexpected = [\"survive\"]\n"
      "[rendered]\nsequences = [\"market\", \"corridor\"]\n";
  const std::string plan = (folder_.path() / "crashes.toml").string();
  std::ofstream(plan) << text;
  bench::StoreWriter writer(file_);
  bench::StoredPlan stored{.name = "crashes", .title = "", .text = text, .run_keys = {}};
  const auto add = [&](const std::string& sequence, const bench::RunOutcome& outcome) {
    const bench::RunIdentity identity{.variant = "vo", .sequence = sequence + " + blank:start=1,duration=1"};
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity, outcome);
    stored.run_keys.push_back(bench::run_key(identity));
  };
  add("market", {.metrics = {{"false_confidence", "", "", 0.3}, {"missed_availability", "", "", 0.2}}});
  add("corridor", {.outcome = bench::Outcome::kCrashed});
  writer.record_plan(stored);
  const ProgramResult result = stats({"faults", "--plan", plan});
  EXPECT_NE(result.out.find("30.00 %"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("20.00 %"), std::string::npos) << result.out;
}

TEST_F(StatsCommand, TheFaultMatrixNamesTheRunsThatItLeavesOut) {
  const std::string text =
      "variants = [\"vo\"]\nfaults = [\"blank:start=1,duration=1\"]\nexpected = [\"survive\"]\n"
      "[rendered]\nsequences = [\"market\"]\n";
  const std::string plan = (folder_.path() / "seeds.toml").string();
  std::ofstream(plan) << text;
  bench::StoreWriter writer(file_);
  bench::StoredPlan stored{.name = "seeds", .title = "", .text = text, .run_keys = {}};
  for (int seed = 1; seed <= 3; ++seed) {
    const bench::RunIdentity identity{
        .variant = "vo", .sequence = "market + blank:start=1,duration=1", .seed = seed};
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity, {.metrics = {{"false_confidence", "", "", seed == 1 ? 0.0 : 0.3},
                                         {"error_after_recovery_m", "", "m", 0.005}}});
    stored.run_keys.push_back(bench::run_key(identity));
  }
  writer.record_plan(stored);
  const ProgramResult result = stats({"faults", "--plan", plan});
  EXPECT_NE(result.out.find("Left out: 2 runs of other seeds or repetitions"), std::string::npos)
      << result.out;
  const nlohmann::json json =
      nlohmann::json::parse(stats({"faults", "--plan", plan, "--format", "json"}).out);
  EXPECT_NE(json.at("notes").dump().find("Left out: 2 runs"), std::string::npos) << json;
}

// As in a summary.
TEST_F(StatsCommand, ASweepNamesCopiesAndRunsWithoutAValue) {
  bench::StoreWriter writer(file_);
  for (int seed = 1; seed <= 3; ++seed) {
    const bench::RunIdentity identity{
        .variant = "vo", .sequence = "a", .seed = seed, .axis = "window.size", .axis_value = 5.0};
    static_cast<void>(writer.acquire(identity));
    writer.finish(identity, {.metrics = seed == 3 ? std::vector<bench::Metric>{{"coverage", "", "", 1.0}}
                                                  : std::vector<bench::Metric>{{"ate_rmse_m", "", "m", 0.01}},
                             .attachments = {{"trajectory", seed == 3 ? "" : "1 0 0 0 0 0 0 1\n"}}});
  }
  const ProgramResult summary = stats({"summary"}), sweep = stats({"sweep"});
  for (const char* const note : {"copies", "No finite value"}) {
    EXPECT_NE(summary.out.find(note), std::string::npos) << summary.out << summary.err;
    EXPECT_NE(sweep.out.find(note), std::string::npos) << sweep.out << sweep.err;
  }
}

TEST_F(StatsCommand, EqualRepetitionsOfASystemSayNothingAboutAnother) {
  {
    bench::StoreWriter writer(file_);
    for (const auto& [system, repetitions] : {std::pair("orb", 2), {"vins", 4}}) {
      for (int repetition = 1; repetition <= repetitions; ++repetition) {
        const bench::RunIdentity identity{
            .system = system, .variant = system, .sequence = "a", .repetition = repetition};
        static_cast<void>(writer.acquire(identity));
        writer.finish(identity,
                      {.metrics = {{"ate_rmse_m", "", "m", 0.01}}, .attachments = {{"trajectory", "x"}}});
      }
    }
  }
  const ProgramResult result = stats({"repeat"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  // 0.05^(1/1) = 0.05, 0.05^(1/3) = 0.37.
  EXPECT_NE(result.out.find("up to 95 % of the runs of orb (1), up to 63 % of the runs of vins (3)"),
            std::string::npos)
      << result.out;
}

TEST_F(StatsCommand, RejectsAMetricThatNoRunHas) {
  fill(1);
  for (const char* command : {"summary", "ablation", "sweep"})
    expect_rejected(stats({command, "--metric", "covrage"}),
                    {"--metric", "\"covrage\"", "coverage, ate_rmse_m"});
}

}  // namespace
}  // namespace stillpoint
