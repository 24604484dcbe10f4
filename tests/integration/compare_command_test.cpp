// SPDX-License-Identifier: BSD-3-Clause
// The gate: finds what was made worse, and raises no alarm where nothing was. Programs are the stand-in
// behind scripts.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

#include "tests/support/fake_sequence.h"
#include "tests/support/program.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReplay = STILLPOINT_BINARY_DIR "/tests/replay_program";

/// A program that is the stand-in with flags.
std::string program(const TemporaryFolder& folder, const std::string& name, const std::string& flags) {
  const fs::path file =
      folder.write(name, "#!/bin/sh\nexec " + std::string(kReplay) + " " + flags + " \"$@\"\n");
  fs::permissions(file, fs::perms::owner_all);
  return file.string();
}

/// What a comparison said, and how it ended.
struct Judgement {
  int exit_code = 0;
  std::string out;
  nlohmann::json json;
};

class Gate {
 public:
  Gate() {
    fake_sequence(folder_, "freiburg1_calm");
    fake_sequence(folder_, "freiburg1_fast");
    plan_ = folder_.write("plan.toml",
                          "variants = [\"stillpoint\"]\n[recorded]\nsequences = [\"freiburg1_*\"]\n");
  }

  [[nodiscard]] Judgement compare(const std::string& base, const std::string& head, int pairs) const {
    const fs::path out = folder_.path() / "out";
    ProgramOptions options;
    options.environment = {"STILLPOINT_DATA=" + folder_.path().string(),
                           "STILLPOINT_REGISTRY=" + (folder_.path() / "none.json").string()};
    const ProgramResult result =
        run_program({"compare", base, head, "--plan", plan_.string(), "--pairs", std::to_string(pairs),
                     "--store", store().string(), "--out", out.string()},
                    options);
    EXPECT_TRUE(fs::exists(out / "compare.json")) << result.err;
    return {result.exit_code, result.out, nlohmann::json::parse(std::ifstream(out / "compare.json"))};
  }

  [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }
  [[nodiscard]] fs::path store() const { return folder_.path() / "store.sqlite"; }

 private:
  TemporaryFolder folder_;
  fs::path plan_;
};

/// Verdict on a metric of the subjects whose names contain `subject`.
std::string verdict_on(const nlohmann::json& comparison, const std::string& metric,
                       const std::string& subject = "") {
  for (const nlohmann::json& change : comparison["changes"]) {
    const bool is_subject = change["subject"].get<std::string>().find(subject) != std::string::npos;
    if (change["metric"] == metric && is_subject) return change["verdict"];
  }
  return "not judged";
}

TEST(Gate, FindsAModuleThatIsFivePercentSlower) {
  const Gate gate;
  const std::string base = program(gate.folder(), "base", "");
  const std::string head = program(gate.folder(), "head", "--slow feature_tracking 1.05");
  const Judgement judgement = gate.compare(base, head, 10);
  EXPECT_EQ(judgement.exit_code, 1) << judgement.out;
  EXPECT_EQ(verdict_on(judgement.json, "feature_tracking"), "worse") << judgement.out;
  EXPECT_NE(verdict_on(judgement.json, "state_optimization"), "worse") << judgement.out;
  EXPECT_EQ(judgement.json["bit_equal"], judgement.json["pairs"]);  // accuracy is proven equal
  EXPECT_EQ(verdict_on(judgement.json, "ate_rmse_m"), "not judged");
}

TEST(Gate, FindsAPathErrorThatIsTenPercentLargerOnOneMotion) {
  const Gate gate;
  const std::string base = program(gate.folder(), "base", "");
  const std::string head = program(gate.folder(), "head", "--worse freiburg1_fast 1.1");
  const Judgement judgement = gate.compare(base, head, 3);
  EXPECT_EQ(judgement.exit_code, 1) << judgement.out;
  EXPECT_EQ(verdict_on(judgement.json, "ate_rmse_m", "freiburg1_fast"), "worse") << judgement.out;
  EXPECT_EQ(verdict_on(judgement.json, "ate_rmse_m", "freiburg1_calm"), "same") << judgement.out;
  const std::ifstream file(gate.folder().path() / "out" / "compare.xml");
  std::ostringstream junit;
  junit << file.rdbuf();
  EXPECT_NE(junit.str().find("<failure message="), std::string::npos);
}

TEST(Gate, RaisesNoAlarmInTwentyComparisonsOfAProgramWithItself) {
  const Gate gate;
  for (int i = 0; i < 20; ++i) {
    // Each pair of programs draws other times, because programs are known by their content.
    const std::string number = std::to_string(i);
    const std::string base = program(gate.folder(), "base", "--out base" + number);
    const std::string head = program(gate.folder(), "head", "--out head" + number);
    const Judgement judgement = gate.compare(base, head, 5);
    EXPECT_NE(judgement.exit_code, 1) << judgement.out;
    EXPECT_NE(judgement.exit_code, 2) << judgement.out;
  }
}

TEST(Gate, SaysThatACommitIsTheSameAsItself) {
  const Gate gate;
  const std::string base = program(gate.folder(), "base", "");
  static_cast<void>(gate.compare(base, base, 1));
  const std::string build = gate.store().string() + "@base-";
  const ProgramResult result = run_program({"compare", build, build});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_NE(result.out.find(": same\n"), std::string::npos) << result.out;
}

TEST(Gate, IsWorseWhereARunIsNewlyLost) {
  const Gate gate;
  const std::string base = program(gate.folder(), "base", "");
  const std::string head = program(gate.folder(), "head", "--crash-after 5");
  const Judgement judgement = gate.compare(base, head, 1);
  EXPECT_EQ(judgement.exit_code, 1);
  EXPECT_EQ(judgement.json["newly_lost"], 4);  // two sequences, base and head twice each
}

TEST(Gate, RefusesWhatItCannotCompare) {
  const TemporaryFolder folder;
  const ProgramResult result =
      run_program({"compare", "abc", "def", "--store", (folder.path() / "no").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("there is no such store"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace stillpoint
