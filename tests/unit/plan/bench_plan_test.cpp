// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/bench_plan.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "bench/config/toml_source.h"
#include "bench/plan/plan_matrix.h"
#include "bench/plan/sequence_registry.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

BenchPlan plan_of(const TemporaryFolder& folder, const std::string& text) {
  return load_plan(folder.write("plan.toml", text).string());
}

void expect_fault(const std::string& text, const std::vector<std::string>& parts) {
  const TemporaryFolder folder;
  expect_input_error([&] { static_cast<void>(plan_of(folder, text)); }, parts);
}

TEST(BenchPlan, EveryEmbeddedPlanLoads) {
  for (const std::string& name : embedded_names(TomlKind::kPlan)) {
    const BenchPlan plan = load_plan(name);
    EXPECT_EQ(plan.name, name);
    EXPECT_FALSE(plan.rendered.sequences.empty() && plan.recorded.sequences.empty()) << name;
  }
}

TEST(BenchPlan, UnknownKeyAndVariantErrorsSuggestTheNearestName) {
  expect_fault("[rendered]\nsecond = 3", {"plan.toml:2: unknown key \"rendered.second\"; did you mean"});
  expect_fault("rendered.variants = [\"voo\"]", {"unknown config \"voo\"", "\"vo\"?"});
}

TEST(BenchPlan, RejectsInvalidPlans) {
  expect_fault("title = ", {"plan.toml:1: invalid TOML"});
  expect_fault("repetitions = 0", {"plan.toml:1: \"repetitions\" is 0, out of range"});
  expect_fault("seeds = [1.5]", {"\"seeds\" must be a list of integers"});
  expect_fault("protocols = [\"strict:se4\"]", {"unknown protocol \"strict:se4\"", "\"strict:se3\"?"});
  expect_fault("cores = \"0,x\"", {"cores \"0,x\"", "not a processor"});
  expect_fault("variants = [\"vo\"]\n[config]\nfrontend.max_featurs = 5",
               {"frontend.max_featurs", "max_features"});
  expect_fault("[synth]\nwalker = 2", {"synth.walker", "\"walkers\"?"});
  expect_fault("[sweep]\nfrontend.max_features = 5", {"must be a list of numbers"});
  expect_fault("variants = [\"vo\"]\n[sweep]\nfrontend.max_features = [-5]",
               {"max_features", "out of range"});
  expect_fault("[sweep]\nsynth.depth.noise = [0.1]", {"synth.depth.noise", "depth.noise_per_m"});
}

TEST(PlanMatrix, MultipliesSequencesSeedsRepetitionsAndVariants) {
  const TemporaryFolder folder;
  const BenchPlan plan = plan_of(folder,
                                 "variants = [\"stillpoint\", \"vo\"]\nseeds = [1, 2]\nrepetitions = 3\n"
                                 "[rendered]\nsequences = [\"walking_xyz*\", \"market\"]");
  const PlanMatrix matrix = expand_plan(plan, "abc", {});
  // walking_xyz, walking_xyz_empty and market; 2 seeds, 3 repetitions, 2 variants.
  EXPECT_EQ(matrix.runs.size(), 3u * 2u * 3u * 2u);
  EXPECT_EQ(matrix.sequences.size(), 6u);  // one rendering per seed
  std::set<std::string> keys;
  for (const PlannedRun& run : matrix.runs) keys.insert(run_key(run.identity));
  EXPECT_EQ(keys.size(), matrix.runs.size());
  EXPECT_EQ(matrix.runs[0].identity.variant, "stillpoint");
  EXPECT_EQ(matrix.runs[1].identity.variant, "vo");  // variants alternate
}

TEST(PlanMatrix, MaxFramesChangesTheSequenceId) {
  const TemporaryFolder folder;
  const std::string text = "variants = [\"vo\"]\n[rendered]\nsequences = [\"walking_xyz\"]\n";
  const PlannedRun whole = expand_plan(plan_of(folder, text), "", {}).runs.front();
  const PlannedRun part = expand_plan(plan_of(folder, "max_frames = 30\n" + text), "", {}).runs.front();
  EXPECT_EQ(part.max_frames, 30);
  EXPECT_EQ(part.identity.sequence_id, whole.identity.sequence_id + "-first-30");
  EXPECT_NE(run_key(part.identity), run_key(whole.identity));
}

TEST(PlanMatrix, ASequenceWithAFaultIsADifferentSequence) {
  const TemporaryFolder folder;
  const BenchPlan plan = plan_of(folder,
                                 "variants = [\"vo\"]\nfaults = [\"none\", \"blank:start=3,duration=1\"]\n"
                                 "[rendered]\nsequences = [\"walking_xyz\"]");
  const PlanMatrix matrix = expand_plan(plan, "abc", {});
  ASSERT_EQ(matrix.runs.size(), 2u);
  EXPECT_EQ(matrix.sequences.size(), 1u);  // rendered once
  EXPECT_EQ(matrix.runs[0].fault, "");
  EXPECT_EQ(matrix.runs[1].fault, "blank:start=3,duration=1,amount=0,seed=1");
  EXPECT_EQ(matrix.runs[1].identity.sequence,
            matrix.runs[0].identity.sequence + " + blank:start=3,duration=1");
  EXPECT_NE(matrix.runs[1].identity.sequence_id, matrix.runs[0].identity.sequence_id);
  expect_fault("variants = [\"vo\"]\nfaults = [\"blnk\"]\n[rendered]\nsequences = [\"walking_xyz\"]",
               {"plan.toml:2", "\"blnk\" is no kind of fault"});
}

TEST(PlanMatrix, IncludesOnlyRunsThatMatchAllFilters) {
  const TemporaryFolder folder;
  const BenchPlan plan = plan_of(folder,
                                 "variants = [\"stillpoint\", \"vo\"]\n"
                                 "[rendered]\nsequences = [\"walking_xyz*\", \"market\"]");
  EXPECT_EQ(expand_plan(plan, "abc", {"walking*"}).runs.size(), 4u);
  const PlanMatrix one = expand_plan(plan, "abc", {"market", "v*"});
  EXPECT_EQ(one.runs.size(), 1u);
  EXPECT_EQ(one.keys.size(), 6u);  // keys are those of the unfiltered plan
}

TEST(PlanMatrix, SweepsOneKeyAtATime) {
  const TemporaryFolder folder;
  const BenchPlan plan = plan_of(folder,
                                 "variants = [\"vo\"]\n[rendered]\nsequences = [\"market\"]\n"
                                 "[sweep]\nfrontend.max_features = [50, 100]\nsynth.walkers = [0, 2, 4]");
  const PlanMatrix matrix = expand_plan(plan, "abc", {});
  ASSERT_EQ(matrix.runs.size(), 5u);
  EXPECT_EQ(matrix.sequences.size(),
            4u);  // the unmodified preset for the first axis, and one per number of walkers
  EXPECT_EQ(matrix.runs[1].identity.axis, "frontend.max_features");
  EXPECT_EQ(matrix.runs[1].identity.axis_value, 100.0);
  EXPECT_NE(matrix.runs[0].identity.config_hash, matrix.runs[1].identity.config_hash);
  EXPECT_EQ(matrix.sequences[matrix.runs[4].sequence].rendering->walkers, 4);
}

TEST(PlanMatrix, RejectsUnknownSequences) {
  const TemporaryFolder folder;
  expect_input_error(
      [&] {
        static_cast<void>(expand_plan(plan_of(folder, "[rendered]\nsequences = [\"walkin_xyz\"]"), "", {}));
      },
      {"sequence \"walkin_xyz\"", "did you mean \"walking_xyz\"?"});
  expect_input_error(
      [&] {
        static_cast<void>(expand_plan(plan_of(folder, "[recorded]\nsequences = [\"no_such\"]"), "", {}));
      },
      {"sequence \"no_such\"", "stillpoint data add"});
}

TEST(PlanMatrix, MarksAnOptionalSequenceThatIsNotAvailable) {
  const TemporaryFolder folder;
  const PlanMatrix matrix = expand_plan(
      plan_of(folder, "variants = [\"vo\"]\n[recorded]\nsequences = [\"no_such\"]\nrequired = false"), "",
      {});
  ASSERT_EQ(matrix.runs.size(), 1u);
  EXPECT_NE(matrix.sequences.front().unavailable_reason.find("STILLPOINT_DATA"), std::string::npos);
}

TEST(SequenceRegistry, DetectsChangedAndMissingFiles) {
  const TemporaryFolder folder;
  folder.write("desk/rgb.txt", "1 rgb/1.png\n");
  setenv("STILLPOINT_REGISTRY", (folder.path() / "sequences.json").c_str(), 1);
  register_sequence(registry_file(),
                    {.name = "desk", .folder = folder.path() / "desk", .checksum = "0", .format = "tum"});
  const RecordedGroup group{.sequences = {"desk"}};
  expect_input_error([&] { static_cast<void>(recorded_sequences(group)); },
                     {"sequence \"desk\"", "expected 0"});
  std::filesystem::remove_all(folder.path() / "desk");
  expect_input_error([&] { static_cast<void>(recorded_sequences(group)); },
                     {"sequence \"desk\"", "does not exist"});
  unsetenv("STILLPOINT_REGISTRY");
}

TEST(SequenceRegistry, RejectsNamesWithSpacesAndMalformedFiles) {
  const TemporaryFolder folder;
  expect_input_error([&] { register_sequence(folder.path() / "r.json", {.name = "a b"}); }, {"\"a b\""});
  const auto broken = folder.write("broken.json", "{");
  expect_input_error([&] { static_cast<void>(read_registry(broken)); },
                     {"broken.json", "not a valid sequence registry"});
}

}  // namespace
}  // namespace stillpoint::bench
