// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/plan_matrix.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "bench/model/stored_run.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// Two sequences and one variant with three pairs, of two programs that accept the perturbation.
class PairedPlan : public testing::Test {
 protected:
  PlanMatrix expanded(const std::string& settings = "", bool perturbed = true) {
    const fs::path file = folder_.write("plan.toml",
                                        "variants = [\"vo\"]\nkind = \"accuracy\"\n"
                                        "[rendered]\nsequences = [\"walking_xyz\", \"market\"]\n" +
                                            settings);
    const ProgramPair programs{folder_.write("base", "a"), folder_.write("head", "b"), perturbed};
    return paired_plan(single_runs(load_plan(file.string())), programs, 3);
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(PairedPlan, AlternatesBaseAndHeadWithinEachSequence) {
  const PlanMatrix matrix = expanded();
  ASSERT_EQ(matrix.runs.size(), 12u);
  EXPECT_EQ(matrix.keys.size(), 12u);
  std::string order;
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(matrix.runs[i].sequence, 0u);
    EXPECT_EQ(matrix.runs[i].identity.kind, "timing");
    order += matrix.runs[i].program.filename().string() + " ";
  }
  EXPECT_EQ(order, "base head head base base head ");
}

TEST_F(PairedPlan, PerturbsEachPairButTheFirstWithItsOwnSeed) {
  const PlanMatrix matrix = expanded();
  for (std::size_t i = 0; i < 6; ++i) {
    const PlannedRun& run = matrix.runs[i];
    const auto seed = static_cast<std::int64_t>(i / 2);
    EXPECT_EQ(run.identity.repetition, seed + 1);
    EXPECT_EQ(is_perturbed(run.identity.config_hash), seed > 0);
    EXPECT_EQ(unperturbed_hash(run.identity.config_hash), matrix.runs[0].identity.config_hash);
    const std::string setting = "pipeline.perturbation_seed=" + std::to_string(seed);
    EXPECT_EQ(run.config.settings.back() == setting, seed > 0);
  }
}

TEST_F(PairedPlan, DoesNotPerturbProgramsWithoutTheKeyOrSweepsOverIt) {
  for (const PlannedRun& run : expanded("", false).runs) EXPECT_FALSE(is_perturbed(run.identity.config_hash));
  for (const PlannedRun& run : expanded("[sweep]\npipeline.perturbation_seed = [4, 5]\n").runs)
    EXPECT_EQ(run.config.settings.back(),
              "pipeline.perturbation_seed=" + std::to_string(static_cast<int>(run.identity.axis_value)));
}

TEST_F(PairedPlan, RecognizesProgramsThatRejectTheKey) {
  EXPECT_TRUE(accept_perturbation({"/bin/true", "/bin/true"}));
  EXPECT_FALSE(accept_perturbation({"/bin/true", "/bin/false"}));
}

}  // namespace
}  // namespace stillpoint::bench
