// SPDX-License-Identifier: BSD-3-Clause
// Faults of plans are reported with their line.
#include "bench/plan/bench_plan.h"

#include <gtest/gtest.h>

#include "bench/plan/plan_matrix.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

PlanMatrix expanded(const TemporaryFolder& folder, const std::string& text) {
  return expand_plan(load_plan(folder.write("plan.toml", text).string()), "", {});
}

void expect_fault(const std::string& text, const std::vector<std::string>& parts) {
  const TemporaryFolder folder;
  expect_input_error([&] { static_cast<void>(expanded(folder, text)); }, parts);
}

TEST(PlanValidation, NamesTheLineOfAnUnknownName) {
  expect_fault("title = \"a\"\nvariants = [\"voo\"]", {"plan.toml:2: unknown config \"voo\"", "\"vo\"?"});
  expect_fault("\n[rendered]\nsequences = [\"walkin_xyz\"]", {"plan.toml:3: sequence", "\"walking_xyz\"?"});
  expect_fault("\n[recorded]\nsequences = [\"no_such\"]", {"plan.toml:3: sequence \"no_such\""});
  expect_fault("\nprotocols = [\"strict:se4\"]", {"plan.toml:2: ", "\"strict:se3\"?"});
  expect_fault("\nbase = \"stilpoint\"", {"plan.toml:2: ", "\"stillpoint\"?"});
  expect_fault("\nmode = \"fast\"", {"plan.toml:2: \"mode\" is \"fast\"", "\"pipelined\""});
}

TEST(PlanValidation, NamesTheLineOfASweepKeyAndNotAnOption) {
  const TemporaryFolder folder;
  const std::string text = "variants = [\"vo\"]\n[sweep]\nfrontend.max_featurs = [5]";
  try {
    static_cast<void>(expanded(folder, text));
    FAIL() << "no InputError was thrown";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("plan.toml:3: unknown key \"frontend.max_featurs\""), std::string::npos)
        << message;
    EXPECT_EQ(message.find("--set"), std::string::npos) << message;
  }
}

TEST(PlanValidation, RejectsKeysWithoutEffectInAllVariants) {
  const std::string with_loops = "variants = [\"stillpoint\", \"stillpoint+loop_closure\"]\n";
  const std::string sweep = "[sweep]\nloop.min_inliers = [30, 50]";
  const TemporaryFolder folder;
  EXPECT_NO_THROW(static_cast<void>(load_plan(folder.write("plan.toml", with_loops + sweep).string())));
  expect_fault("variants = [\"stillpoint\"]\n" + sweep,
               {"plan.toml:3: \"loop.min_inliers\" has no effect in any variant", "loop.enabled = true"});
  expect_fault("variants = [\"vo\"]\n[config]\nimu.noise_scale = 2.0",
               {"plan.toml:3: \"imu.noise_scale\" has no effect", "imu.enabled = true"});
}

TEST(PlanValidation, RejectsValuesThatAreListedTwice) {
  expect_fault("seeds = [1, 2, 1]", {"plan.toml:1: \"seeds\" contains 1 twice", "repetitions"});
  expect_fault("variants = [\"vo\", \"vo\"]", {"plan.toml:1: \"variants\" contains vo twice"});
  expect_fault("[sweep]\nfrontend.max_features = [50, 50]", {"plan.toml:2: ", "contains 50 twice"});
}

TEST(PlanValidation, RejectsPlansWithoutRuns) {
  expect_fault("", {"plan.toml: the plan names no sequence"});
  expect_fault("variants = []\n[rendered]\nsequences = [\"market\"]", {"plan.toml:1: ", "no variant"});
  expect_fault("[rendered]\nsequences = [\"market\"]", {"plan.toml:2: ", "no variant"});
  expect_fault("seeds = []\nvariants = [\"vo\"]\nrendered.sequences = [\"market\"]",
               {"plan.toml:1: the list of seeds is empty"});
}

TEST(PlanValidation, RejectsASweepOfWhatThePlanDoesNotRun) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "seq");
  folder.write("s.toml", "name = \"s\"\ncommand = [\"s\"]\n");
  const auto fault = [&](const std::string& text, const std::vector<std::string>& parts) {
    expect_input_error([&] { static_cast<void>(expanded(folder, text)); }, parts);
  };
  const std::string recorded = "recorded.sequences = [\"./seq\"]\n";
  fault("variants = [\"vo\"]\n" + recorded + "[sweep]\nsynth.walkers = [0, 2]",
        {"plan.toml:4: \"sweep.synth.walkers\"", "add [rendered]"});
  fault("variants = [\"vo\"]\n" + recorded + "[synth]\nwalkers = 2",
        {"plan.toml:4: \"synth.walkers\"", "add [rendered]"});
  fault("systems = [\"s.toml\"]\n" + recorded + "[sweep]\nfrontend.max_features = [50]",
        {"plan.toml:4: \"sweep.frontend.max_features\"", "add variants"});
}

TEST(PlanValidation, APublishedTableIsAFileBesideThePlan) {
  const TemporaryFolder folder;
  const std::string table = "title = \"t\"\nunit = \"m\"\nalignment = \"rigid\"\nmetric = ";
  const auto file = folder.write("mine.toml", table + "\"ate_rmse_m\"\n");
  folder.write("other.toml", table + "\"ate_rmse\"\n");
  const auto plan = [&](const std::string& name) {
    return load_plan(folder.write("plan.toml", "[table]\npublished = [\"" + name + "\"]\n").string());
  };
  EXPECT_EQ(plan("mine.toml").table.published.front(), file.string());
  EXPECT_EQ(plan("mine.toml").files.at("mine.toml"), file.string());
  expect_input_error([&] { static_cast<void>(plan("none.toml")); },
                     {"plan.toml:2: none.toml", "correct the path"});
  expect_input_error([&] { static_cast<void>(plan("other.toml")); },
                     {"plan.toml:2: ", "other.toml", "\"metric\" is \"ate_rmse\", which no run has"});
}

TEST(PlanValidation, ListsInTheConfigTableKeepTheirElements) {
  const TemporaryFolder folder;
  const PlanMatrix matrix = expanded(folder,
                                     "variants = [\"vo\"]\nrendered.sequences = [\"market\"]\n"
                                     "[config]\ndynamic.classes = [\"person\", \"a\\\"b\"]");
  const OdometryConfig config = load_config(matrix.runs.front().config);
  EXPECT_EQ(config.dynamic.classes, (std::vector<std::string>{"person", "a\"b"}));
}

TEST(PlanValidation, ASequenceThatMatchesTwoPatternsOccursOnce) {
  const TemporaryFolder folder;
  const PlanMatrix matrix = expanded(
      folder, "variants = [\"vo\"]\nrendered.sequences = [\"market_empt*\", \"market_empty\", \"market\"]");
  EXPECT_EQ(matrix.runs.size(), 2u);
}

}  // namespace
}  // namespace stillpoint::bench
