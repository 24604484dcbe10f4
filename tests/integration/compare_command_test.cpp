// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint compare` detects regressions and reports none for equal programs. The programs are scripts that
// call the replay program.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "bench/store/maintenance/maintenance.h"
#include "bench/store/store_writer.h"
#include "tests/support/program.h"
#include "tests/support/sequences/fake_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReplay = STILLPOINT_BINARY_DIR "/tests/replay_program";

/// A script that calls the replay program with additional options. Its content is part of the seed of the
/// simulated times, and therefore contains no path.
std::string write_program(const TemporaryFolder& folder, const std::string& name, const std::string& flags) {
  const fs::path replay = folder.path() / "replay";
  if (!fs::exists(replay)) fs::create_symlink(kReplay, replay);
  const fs::path file = folder.write(name, "#!/bin/sh\nexec \"${0%/*}/replay\" " + flags + " \"$@\"\n");
  fs::permissions(file, fs::perms::owner_all);
  return file.string();
}

/// Output and exit code of a comparison.
struct CompareResult {
  int exit_code = 0;
  std::string out;
  std::string err;
  nlohmann::json json;
};

class CompareFixture {
 public:
  CompareFixture() {
    fake_sequence(folder_, "freiburg1_slow");
    fake_sequence(folder_, "freiburg1_fast");
    plan_ = folder_.write("plan.toml",
                          "variants = [\"stillpoint\"]\n[recorded]\nsequences = [\"freiburg1_*\"]\n");
  }

  /// @param pairs 0: as many as the plan needs
  [[nodiscard]] CompareResult compare(const std::string& base, const std::string& head, int pairs) const {
    const fs::path out = folder_.path() / "out";
    ProgramOptions options;
    options.environment = {"STILLPOINT_DATA=" + folder_.path().string(),
                           "STILLPOINT_REGISTRY=" + (folder_.path() / "none.json").string()};
    std::vector<std::string> arguments = {
        "compare", base, head, "--plan", plan_.string(), "--store", store().string(), "--out", out.string()};
    if (pairs > 0) arguments.insert(arguments.end(), {"--pairs", std::to_string(pairs)});
    const ProgramResult result = run_program(arguments, options);
    EXPECT_TRUE(fs::exists(out / "compare.json")) << result.err;
    return {result.exit_code, result.out, result.err,
            nlohmann::json::parse(std::ifstream(out / "compare.json"))};
  }

  [[nodiscard]] std::string junit() const {
    std::ostringstream text;
    text << std::ifstream(folder_.path() / "out" / "compare.xml").rdbuf();
    return text.str();
  }

  [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }
  [[nodiscard]] fs::path store() const { return folder_.path() / "store.sqlite"; }

 private:
  TemporaryFolder folder_;
  fs::path plan_;
};

/// Class of the change of a metric, for the first subject whose name contains `subject`.
std::string change_class(const nlohmann::json& comparison, const std::string& metric,
                         const std::string& subject = "") {
  for (const nlohmann::json& change : comparison["changes"]) {
    const bool is_subject = change["subject"].get<std::string>().find(subject) != std::string::npos;
    if (change["metric"] == metric && is_subject) return change["result"];
  }
  return "not compared";
}

TEST(CompareCommand, DetectsAModuleThatIsFivePercentSlower) {
  const CompareFixture fixture;
  const std::string base = write_program(fixture.folder(), "base", "");
  const std::string head = write_program(fixture.folder(), "head", "--slow feature_tracking 1.05");
  const CompareResult result = fixture.compare(base, head, 10);
  EXPECT_EQ(result.exit_code, 1) << result.out;
  EXPECT_EQ(change_class(result.json, "feature_tracking"), "worse") << result.out;
  EXPECT_NE(change_class(result.json, "state_optimization"), "worse") << result.out;
  EXPECT_EQ(result.json["bit_equal"], result.json["pairs"]);  // accuracy is identical
  EXPECT_EQ(change_class(result.json, "ate_rmse_m"), "not compared");
}

TEST(CompareCommand, DetectsATenPercentLargerErrorOnOneSequence) {
  const CompareFixture fixture;
  const std::string base = write_program(fixture.folder(), "base", "");
  const std::string head = write_program(fixture.folder(), "head", "--worse freiburg1_fast 1.1");
  const CompareResult result = fixture.compare(base, head, 6);
  EXPECT_EQ(result.exit_code, 1) << result.out;
  EXPECT_EQ(change_class(result.json, "ate_rmse_m", "freiburg1_fast"), "worse") << result.out;
  EXPECT_EQ(change_class(result.json, "ate_rmse_m", "freiburg1_slow"), "same") << result.out;
  EXPECT_NE(fixture.junit().find("<failure message="), std::string::npos);
}

TEST(CompareCommand, ALargerErrorInOneReplicateIsInconclusive) {
  const CompareFixture fixture;
  const std::string base = write_program(fixture.folder(), "base", "");
  const std::string head = write_program(fixture.folder(), "head", "--worse freiburg1_fast 1.1");
  const CompareResult result = fixture.compare(base, head, 1);
  EXPECT_EQ(result.exit_code, 3) << result.out;
  EXPECT_EQ(change_class(result.json, "ate_rmse_m", "freiburg1_fast"), "inconclusive") << result.out;
  EXPECT_NE(result.out.find("run with --pairs "), std::string::npos) << result.out;
}

TEST(CompareCommand, EqualRepetitionsOfAProgramWithoutPerturbationAreOnePairAndMakeAChangeExact) {
  const CompareFixture fixture;
  const std::string base = write_program(fixture.folder(), "base", "--unperturbed");
  const std::string head = write_program(fixture.folder(), "head", "--worse freiburg1_fast 1.1");
  const CompareResult result = fixture.compare(base, head, 6);
  EXPECT_EQ(change_class(result.json, "ate_rmse_m", "freiburg1_fast"), "worse") << result.out;
  EXPECT_EQ(change_class(result.json, "ate_rmse_m", "freiburg1_slow"), "same") << result.out;
  EXPECT_EQ(result.json["compared"], 12);
  EXPECT_NE(result.out.find("| 1   | 0.006977 m | 0.007675 m | +10.0 % | exact"), std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("does not accept pipeline.perturbation_seed"), std::string::npos) << result.out;
}

TEST(CompareCommand, ExecutesAsManyPairsAsThePlanNeeds) {
  const CompareFixture fixture;
  const std::string base = write_program(fixture.folder(), "base", "");
  const CompareResult result = fixture.compare(base, base, 0);
  // 5 * 2 + 14 = 24 tests: 2 / C(14, 7) = 5.8e-4 is below 0.05 / 24 = 2.1e-3, 2 / C(12, 6) = 2.2e-3 is not.
  EXPECT_EQ(result.json["pairs"], 2 * 7) << result.out;
  EXPECT_EQ(result.json["bit_equal"], 2 * 7);
}

TEST(CompareCommand, ReportsNoRegressionInTwentyComparisonsOfEqualPrograms) {
  const CompareFixture fixture;
  for (int i = 0; i < 20; ++i) {
    // Different contents, so that each pair of programs is another build and has other simulated times.
    const std::string number = std::to_string(i);
    const std::string base = write_program(fixture.folder(), "base", "--out base" + number);
    const std::string head = write_program(fixture.folder(), "head", "--out head" + number);
    const CompareResult result = fixture.compare(base, head, 5);
    EXPECT_NE(result.exit_code, 1) << result.out;
    EXPECT_NE(result.exit_code, 2) << result.out;
  }
}

TEST(CompareCommand, ACommitIsTheSameAsItself) {
  const CompareFixture fixture;
  const std::string base = write_program(fixture.folder(), "base", "");
  static_cast<void>(fixture.compare(base, base, 1));
  const std::string build = fixture.store().string() + "@base-";
  const ProgramResult result = run_program({"compare", build, build});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_NE(result.out.find(": same\n"), std::string::npos) << result.out;
}

TEST(CompareCommand, ANewlyFailedRunIsARegression) {
  const CompareFixture fixture;
  const std::string base = write_program(fixture.folder(), "base", "");
  const std::string head = write_program(fixture.folder(), "head", "--crash-after 5");
  const CompareResult result = fixture.compare(base, head, 1);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.json["newly_failed"], 2);  // two sequences
  EXPECT_EQ(result.json["head_failed"], 2);
  EXPECT_EQ(result.json["compared"], 0);
  EXPECT_NE(fixture.junit().find("failures=\"1\" errors=\"1\""), std::string::npos) << fixture.junit();
}

TEST(CompareCommand, ProgramsThatWriteNoResultAreAnError) {
  const CompareFixture fixture;
  const CompareResult result = fixture.compare("/bin/true", "/bin/true", 1);
  EXPECT_EQ(result.exit_code, 2) << result.out;
  EXPECT_NE(result.err.find("all 2 pairs of runs failed on both sides; the first failure: stillpoint on"),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("without writing result.json"), std::string::npos) << result.err;
  EXPECT_EQ(result.json["result"], "error");
  EXPECT_NE(fixture.junit().find("<error message="), std::string::npos) << fixture.junit();
}

TEST(CompareCommand, BuildsWithoutCommonRunsAreInconclusive) {
  const CompareFixture fixture;
  const std::string base = write_program(fixture.folder(), "base", "");
  static_cast<void>(fixture.compare(base, base, 1));
  fixture.folder().write("other.json", R"({"stillpoint_store": 2, "plans": [], "runs": [], "accepted": []})");
  const ProgramResult result =
      run_program({"compare", fixture.store().string(), (fixture.folder().path() / "other.json").string()});
  EXPECT_EQ(result.exit_code, 3) << result.out << result.err;
  EXPECT_NE(result.out.find("0 pairs of runs"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("missing in HEAD"), std::string::npos) << result.out;
}

/// A store with a run of this odometry, and four equal ones of a version of another system.
fs::path store_of_two_systems(const TemporaryFolder& folder, const std::string& version, double ate_m) {
  const fs::path file = folder.path() / (version + ".sqlite");
  bench::StoreWriter writer(file);
  const auto add = [&](const bench::RunIdentity& identity, double error_m) {
    const bench::RunOutcome outcome{.metrics = {{"ate_rmse_m", "", "m", error_m}},
                                    .attachments = {{"trajectory", std::to_string(error_m)}}};
    EXPECT_TRUE(bench::add_run(writer, identity, outcome));
  };
  add({.variant = "vo", .sequence = "a", .build = "same"}, 0.01);
  for (int i = 1; i <= 4; ++i)
    add({.system = "slam", .variant = "slam", .sequence = "a", .build = version, .repetition = i}, ate_m);
  return file;
}

// The other system has another build than this odometry.
TEST(CompareCommand, ComparesTheNewestBuildOfEachSystemOfAStore) {
  const TemporaryFolder folder;
  const std::string base = store_of_two_systems(folder, "1.0", 0.02);
  const std::string head = store_of_two_systems(folder, "2.0", 0.08);
  const ProgramResult result = run_program({"compare", base, head});
  EXPECT_EQ(result.exit_code, 1) << result.out << result.err;
  EXPECT_NE(result.out.find("5 pairs of runs: 5 compared"), std::string::npos) << result.out;
  EXPECT_EQ(run_program({"compare", base + "@same", head + "@same"}).exit_code, 0);
}

TEST(CompareCommand, JsonOnStandardOutputIsTheFile) {
  const TemporaryFolder folder;
  const std::string baseline = STILLPOINT_SOURCE_DIR "/bench/baselines/quick_instructions.json";
  const fs::path out = folder.path() / "out";
  const ProgramResult result = run_program({"compare", baseline, baseline, "--json", "--out", out.string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::stringstream file;
  file << std::ifstream(out / "compare.json").rdbuf();
  EXPECT_EQ(result.out, file.str());
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("schema"), 2);
  EXPECT_EQ(json.at("result"), "same");
  EXPECT_EQ(json.at("compared"), json.at("pairs"));
}

TEST(CompareCommand, RejectsAProgramAndAStore) {
  const CompareFixture fixture;
  const ProgramResult result = run_program({"compare", "/bin/true", fixture.folder().path() / "none"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("is not a program, but /bin/true is"), std::string::npos) << result.err;
}

TEST(CompareCommand, RejectsAMissingStore) {
  const TemporaryFolder folder;
  const ProgramResult result =
      run_program({"compare", "abc", "def", "--store", (folder.path() / "no").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("abc: is neither a store nor"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace stillpoint
