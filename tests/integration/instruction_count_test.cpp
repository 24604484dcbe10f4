// SPDX-License-Identifier: BSD-3-Clause
// Instruction counts of callgrind: reproducible, stored, and compared.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/store/store.h"
#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Instructions : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v valgrind >/dev/null 2>&1") != 0) GTEST_SKIP() << "valgrind is not installed";
  }
};

/// Counts by stage of a short profile, written to the folder `name`.
json count_instructions(const TemporaryFolder& folder, const std::string& name, const ProgramOptions& options,
                        const std::string& variant = "") {
  const fs::path out = folder.path() / name;
  const ProgramResult result = run_program({"profile", rendered_sequence().string(), "--instructions",
                                            "--max-frames", "3", "--out", out.string(), "--variant", variant},
                                           options);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return json::parse(std::ifstream(out / "instructions.json")).at("stages");
}

TEST_F(Instructions, AreEqualInTwoRuns) {
  const TemporaryFolder folder;
  ProgramOptions larger_environment;
  larger_environment.environment = {"SOMETHING=" + std::string(1000, 'x'), "LC_ALL=de_DE.UTF-8"};
  const json first = count_instructions(folder, "a", {});
  const json second = count_instructions(folder, "a_folder_with_a_longer_name", larger_environment);
  EXPECT_EQ(first, second);
  EXPECT_GT(first.at("tracking"), 1'000'000);  // three images of 320x240, each read at least once
}

/// The store of a plan of one run.
std::string store_of_plan(const TemporaryFolder& folder, const std::string& variant, int frames) {
  const fs::path plan =
      folder.write("plan.toml", "kind = \"instructions\"\nmax_frames = " + std::to_string(frames) +
                                    "\nvariants = [\"" + variant + "\"]\n[recorded]\nsequences = [\"" +
                                    rendered_sequence().filename().string() + "\"]\n");
  std::string store = (folder.path() / "store.sqlite").string();
  ProgramOptions options;
  options.environment = {"STILLPOINT_DATA=" + rendered_sequence().parent_path().string()};
  const ProgramResult result = run_program(
      {"bench", plan.string(), "--store", store, "--out", (folder.path() / "o").string()}, options);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return store;
}

TEST_F(Instructions, OfAPlanAreStoredAndCompared) {
  const TemporaryFolder folder;
  const std::string store = store_of_plan(folder, "stillpoint", 15);
  const bench::StoredRun run = bench::Store(store).runs().at(0);
  EXPECT_GT(bench::metric_value(run, "instructions").value_or(0.0), 1e6);
  EXPECT_TRUE(run.costs.empty());  // times under valgrind are not meaningful
  EXPECT_FALSE(bench::metric_value(run, "process_cpu_s"));

  const std::string baseline = (folder.path() / "baseline.json").string();
  ASSERT_EQ(run_program({"store", "export", baseline, "--numbers", "--store", store}).exit_code, 0);
  EXPECT_LT(fs::file_size(baseline), 10'000u);
  const ProgramResult same = run_program({"compare", baseline, store});
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
  EXPECT_NE(same.out.find("instructions"), std::string::npos) << same.out;
}

/// Instructions of library worker threads would be missing in the counts of their stage.
TEST_F(Instructions, OfAPlanEqualThoseOfAProfile) {
  constexpr const char* kOpenCvTracker = "vo+dynamic_vins";
  const TemporaryFolder folder;
  const bench::StoredRun run = bench::Store(store_of_plan(folder, kOpenCvTracker, 3)).runs().at(0);
  const double of_plan = bench::metric_value(run, "instructions_tracking").value_or(0.0);
  const double of_profile = count_instructions(folder, "p", {}, kOpenCvTracker).at("tracking");
  EXPECT_NEAR(of_plan / of_profile, 1.0, 0.002);  // different arguments and heap
}

TEST_F(Instructions, IncreaseIsDetectedByCompare) {
  const TemporaryFolder folder;
  const auto exported = [&](const std::string& name, double instructions) {
    const json run = {
        {"key", name},
        {"identity",
         {{"system", "stillpoint"},
          {"variant", "vo"},
          {"sequence", "office"},
          {"sequence_id", "1"},
          {"config_hash", ""},
          {"build", name},
          {"mode", "sequential"},
          {"kind", "instructions"},
          {"cores", ""},
          {"seed", 1},
          {"repetition", 1},
          {"axis", ""},
          {"axis_value", 0.0}}},
        {"outcome", "ok"},
        {"detail", ""},
        {"started", ""},
        {"ended", ""},
        {"metrics", {{{"name", "instructions"}, {"protocol", ""}, {"unit", ""}, {"value", instructions}}}},
        {"costs", json::array()},
        {"attachments", json::object()},
        {"manifest", ""}};
    return folder
        .write(name + ".json",
               json{{"stillpoint_store", 2}, {"plans", json::array()}, {"runs", {run}}}.dump())
        .string();
  };
  const std::string base = exported("base", 1e9);
  // One pair is sufficient, as counts are reproducible. The margin is 1 %.
  EXPECT_EQ(run_program({"compare", base, exported("slower", 1.02e9)}).exit_code, 1);
  EXPECT_EQ(run_program({"compare", base, exported("same", 1.005e9)}).exit_code, 0);
}

TEST(InstructionsWithoutValgrind, ReportTheRequiredPackage) {
  const TemporaryFolder folder;
  ProgramOptions options;
  options.environment = {"PATH=" + folder.path().string()};
  const ProgramResult result = run_program(
      {"profile", rendered_sequence().string(), "--instructions", "--out", (folder.path() / "out").string()},
      options);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("Debian package \"valgrind\""), std::string::npos) << result.err;
}

}  // namespace
}  // namespace stillpoint
