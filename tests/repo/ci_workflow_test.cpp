// SPDX-License-Identifier: BSD-3-Clause
// Checks that the workflow files of scripts/ci_example are valid YAML and that all scripts they call exist.
#include <algorithm>
#include <filesystem>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = STILLPOINT_SOURCE_DIR;

/// Collects the script paths in all strings below a node.
void append_scripts(std::vector<std::string>& scripts, const YAML::Node& node) {
  if (node.IsScalar()) {
    const std::string text = node.Scalar();
    const std::regex script(R"(scripts/[\w/]+\.sh)");
    for (std::sregex_iterator found(text.begin(), text.end(), script), end; found != end; ++found)
      scripts.push_back(found->str());
  }
  for (const auto& child : node) append_scripts(scripts, node.IsMap() ? child.second : child);
}

void expect_scripts_exist(const YAML::Node& job, const std::string& main_script) {
  std::vector<std::string> scripts;
  append_scripts(scripts, job);
  EXPECT_NE(std::find(scripts.begin(), scripts.end(), main_script), scripts.end());
  for (const std::string& script : scripts) EXPECT_EQ(access((kRoot / script).c_str(), X_OK), 0) << script;
}

TEST(CiExample, GithubRunsTheGateTheHistoryAndThePortability) {
  const YAML::Node jobs = YAML::LoadFile(kRoot / "scripts/ci_example/github.yml")["jobs"];
  ASSERT_TRUE(jobs);
  expect_scripts_exist(jobs["gate"], "scripts/ci_example/gate.sh");
  expect_scripts_exist(jobs["history"], "scripts/ci_example/history.sh");
  expect_scripts_exist(jobs["portability"], "scripts/portability.sh");
}

TEST(CiExample, GitlabRunsTheGateTheHistoryAndThePortability) {
  const YAML::Node file = YAML::LoadFile(kRoot / "scripts/ci_example/gitlab.yml");
  for (const char* job : {"gate", "history"}) {
    EXPECT_TRUE(file[file[job]["extends"].Scalar()]) << job;
    expect_scripts_exist(file[job], std::string("scripts/ci_example/") + job + ".sh");
  }
  EXPECT_TRUE(file[file["portability"]["extends"].Scalar()]);
  expect_scripts_exist(file["portability"], "scripts/portability.sh");
}

}  // namespace
