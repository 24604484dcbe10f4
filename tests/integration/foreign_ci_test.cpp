// SPDX-License-Identifier: BSD-3-Clause
// The pipelines for the repository of another system (bench/systems/examples/github.yml, gitlab.yml): their
// shell steps are executed in the repository of the made-up project, with fakes of what installs packages.
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <sys/wait.h>

#include <map>
#include <sstream>

#include <yaml-cpp/yaml.h>

#include "bench/store/store.h"
#include "tests/support/made_up_project.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

const fs::path kExamples = fs::path(STILLPOINT_SOURCE_DIR) / "bench/systems/examples";

using Variables = std::map<std::string, std::string>;

/// Executes shell steps in the repository of the project.
class Pipeline {
 public:
  Pipeline() {
    for (const char* name : {"apt-get", "curl"}) {
      const fs::path fake =
          project_.folder().write(std::string("bin/") + name,
                                  "#!/bin/sh\necho \"" + std::string(name) + " $*\" >>\"$HOME/installed\"\n");
      chmod(fake.c_str(), 0755);
    }
    fs::create_symlink(STILLPOINT_BINARY_DIR "/stillpoint", project_.file("bin/stillpoint"));
    std::ostringstream description;
    description << std::ifstream(project_.file("slam.toml")).rdbuf();
    std::string text = description.str();
    text.replace(text.find("\"repository\""), 12, "\".\"");
    project_.folder().write("repository/slam.toml", text);
    fs::copy_file(project_.file("plan.toml"), project_.file("repository/slam_plan.toml"));
  }

  [[nodiscard]] const MadeUpProject& project() const { return project_; }
  [[nodiscard]] std::string file(const std::string& name) const {
    return project_.file("repository/" + name);
  }

  /// @return exit status of the first step that fails; 0 if none does
  int execute(const std::vector<std::string>& steps, const Variables& variables) const {
    for (const std::string& step : steps) {
      const fs::path script = project_.folder().write("step.sh", step + "\n");
      std::string command = "cd '" + file(".") + "' && env HOME='" + project_.file("") + "' PATH='" +
                            project_.file("bin") + "':\"$PATH\" GITHUB_STEP_SUMMARY='" +
                            project_.file("summary.md") + "'";
      for (const std::string& setting : project_.environment()) command += " '" + setting + "'";
      for (const auto& [name, value] : variables) command += " '" + name + "=" + value + "'";
      command += " bash --noprofile --norc -eo pipefail '" + script.string() + "' >'" + project_.file("log") +
                 "' 2>&1";
      const int status = WEXITSTATUS(std::system(command.c_str()));
      if (status != 0) return status;
    }
    return 0;
  }

  [[nodiscard]] std::string log() const {
    std::ostringstream text;
    text << std::ifstream(project_.file("log")).rdbuf();
    return text.str();
  }

 private:
  MadeUpProject project_;
};

Variables variables_of(const YAML::Node& node, const Variables& expressions = {}) {
  Variables variables;
  for (const auto& entry : node) {
    const auto value = entry.second.as<std::string>();
    const auto known = expressions.find(value);
    EXPECT_TRUE(known != expressions.end() || value.find("${{") == std::string::npos) << value;
    variables[entry.first.as<std::string>()] = known == expressions.end() ? value : known->second;
  }
  return variables;
}

struct GithubJob {
  std::vector<std::string> steps;
  Variables variables;
};

GithubJob github_job(const std::string& name, const Variables& expressions) {
  const YAML::Node file = YAML::LoadFile(kExamples / "github.yml");
  GithubJob job{.steps = {}, .variables = variables_of(file["env"])};
  for (const auto& [variable, value] : variables_of(file["jobs"][name]["env"], expressions))
    job.variables[variable] = value;
  for (const YAML::Node& step : file["jobs"][name]["steps"]) {
    if (step["run"]) job.steps.push_back(step["run"].as<std::string>());
  }
  EXPECT_GE(job.steps.size(), 5u);
  return job;
}

int run_github(const Pipeline& pipeline, const std::string& name, const Variables& expressions) {
  const GithubJob job = github_job(name, expressions);
  return pipeline.execute(job.steps, job.variables);
}

int run_gitlab(const Pipeline& pipeline, const std::string& name, const Variables& variables) {
  const YAML::Node file = YAML::LoadFile(kExamples / "gitlab.yml");
  const YAML::Node base = file[file[name]["extends"].as<std::string>()];
  Variables all = variables_of(base["variables"]);
  all.insert(variables.begin(), variables.end());
  std::vector<std::string> steps;
  for (const YAML::Node& part : {base["before_script"], file[name]["script"]}) {
    for (const YAML::Node& step : part) steps.push_back(step.as<std::string>());
  }
  EXPECT_GE(steps.size(), 4u);
  return pipeline.execute(steps, all);
}

TEST(ForeignCi, TheGateFailsForAWorseCommitOnly) {
  const Pipeline pipeline;
  const auto github = [&](std::size_t base, std::size_t head) {
    return run_github(pipeline, "gate",
                      {{"${{ github.event.pull_request.base.sha }}", pipeline.project().commit(base)},
                       {"${{ github.sha }}", pipeline.project().commit(head)}});
  };
  const auto gitlab = [&](std::size_t base, std::size_t head) {
    return run_gitlab(pipeline, "gate",
                      {{"CI_MERGE_REQUEST_DIFF_BASE_SHA", pipeline.project().commit(base)},
                       {"CI_COMMIT_SHA", pipeline.project().commit(head)}});
  };
  EXPECT_EQ(github(6, 7), 1) << pipeline.log();
  EXPECT_TRUE(fs::exists(pipeline.file("gate/compare.md")));
  EXPECT_TRUE(fs::exists(pipeline.project().file("installed")));
  fs::remove_all(pipeline.file("gate"));
  EXPECT_EQ(github(5, 6), 0) << pipeline.log();
  EXPECT_GT(fs::file_size(pipeline.project().file("summary.md")), 0u);
  fs::remove_all(pipeline.file("gate"));
  EXPECT_EQ(gitlab(6, 7), 1) << pipeline.log();
  EXPECT_TRUE(fs::exists(pipeline.file("gate/compare.xml")));
  fs::remove_all(pipeline.file("gate"));
  EXPECT_EQ(gitlab(2, 3), 0) << pipeline.log();
}

TEST(ForeignCi, TheHistoryHasADashboard) {
  const Pipeline pipeline;
  EXPECT_EQ(run_github(pipeline, "history", {}), 0) << pipeline.log();
  EXPECT_EQ(bench::Store(pipeline.file("history/runs.sqlite")).run_headers().size(), 22u);
  EXPECT_TRUE(fs::exists(pipeline.file("dashboard/index.html")));
  fs::remove_all(pipeline.file("dashboard"));
  EXPECT_EQ(run_gitlab(pipeline, "history", {}), 0) << pipeline.log();
  EXPECT_TRUE(fs::exists(pipeline.file("dashboard/index.html")));
}

TEST(ForeignCi, ACommitIsSearchedByHand) {
  const Pipeline pipeline;
  const std::string range = pipeline.project().commit(6) + "..main";
  EXPECT_EQ(run_github(pipeline, "bisect",
                       {{"${{ inputs.metric }}", "ate_rmse_m"}, {"${{ inputs.range }}", range}}),
            0)
      << pipeline.log();
  EXPECT_NE(pipeline.log().find(pipeline.project().commit(7)), std::string::npos) << pipeline.log();
  EXPECT_EQ(run_gitlab(pipeline, "bisect", {{"METRIC", "ate_rmse_m"}, {"RANGE", range}}), 0);
  EXPECT_NE(pipeline.log().find("0 built now"), std::string::npos) << pipeline.log();
}

}  // namespace
}  // namespace stillpoint
