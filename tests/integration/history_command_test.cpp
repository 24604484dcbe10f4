// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint history`, `bisect` and `compare FILE@COMMIT` on a made-up project of another author.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "bench/analysis/commit_history.h"
#include "bench/store/store.h"
#include "tests/support/made_up_project.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> history_arguments(const MadeUpProject& project, const std::string& store) {
  return {"history",  "HEAD",
          "--system", project.file("slam.toml"),
          "--plan",   project.file("plan.toml"),
          "--store",  project.file(store)};
}

/// The command line of a shell that executes the program. @param before words before it
std::string shell_command(const MadeUpProject& project, const std::string& before,
                          const std::vector<std::string>& arguments) {
  std::string command = before + " env";
  for (const std::string& setting : project.environment()) command += " '" + setting + "'";
  command += " '" STILLPOINT_BINARY_DIR "/stillpoint'";
  for (const std::string& argument : arguments) command += " '" + argument + "'";
  return command + " >'" + project.file("log") + "' 2>&1";
}

/// One for the tests that do not count all builds.
const MadeUpProject& shared_project() {
  static const MadeUpProject project;
  return project;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// Build and outcome of each run, in the order of their start.
std::vector<std::string> builds_in(const std::string& store) {
  std::vector<std::string> builds;
  for (const bench::StoredRun& run : bench::Store(store).runs()) builds.push_back(run.identity.build);
  return builds;
}

// Interrupted by the user, killed, and continued.
TEST(History, FillsAStoreAndContinues) {
  const MadeUpProject project;
  const std::vector<std::string> arguments = history_arguments(project, "runs.sqlite");
  const ProgramResult interrupted = project.run(arguments, {.interrupt_after = "commit 3 of 12"});
  EXPECT_EQ(interrupted.exit_code, 130) << interrupted.out << interrupted.err;
  EXPECT_NE(interrupted.out.find("run the same command again"), std::string::npos) << interrupted.out;
  EXPECT_NE(interrupted.err.find("11 commits left, about "), std::string::npos) << interrupted.err;

  EXPECT_NE(std::system(shell_command(project, "timeout -s KILL 0.6", arguments).c_str()), 0);

  const ProgramResult result = project.run(arguments);
  EXPECT_EQ(result.exit_code, 1) << result.out << result.err;  // one commit is not built
  EXPECT_NE(result.out.find("12 commits: "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("1 not built; 0 failed runs"), std::string::npos) << result.out;
  EXPECT_NE(result.err.find("the build failed: error: no such header"), std::string::npos) << result.err;
  const std::vector<std::string> builds = builds_in(project.file("runs.sqlite"));
  EXPECT_EQ(builds.size(), 22u);
  EXPECT_EQ(std::set<std::string>(builds.begin(), builds.end()).size(), 11u);
  EXPECT_EQ(builds.front(), project.commit(12));  // the newest one
  EXPECT_EQ(builds.back(), project.commit(1));

  const ProgramResult again = project.run(arguments);
  EXPECT_NE(again.out.find("0 executed, 11 stored before, 1 not built"), std::string::npos) << again.out;
  EXPECT_EQ(count_of(again.err, "commit 1 of 1: "), 1u) << again.err;

  // Commits of equal time keep their order.
  std::vector<std::string> measured;
  for (const bench::Commit& commit : bench::commit_history(bench::Store(project.file("runs.sqlite"))).commits)
    measured.push_back(commit.name);
  std::vector<std::string> expected;
  for (const std::size_t number : {1, 2, 3, 4, 5, 6, 7, 9, 10, 11, 12})
    expected.push_back(project.commit(number));
  EXPECT_EQ(measured, expected);
}

/// Names of the folders of builds, in those of all sources.
std::vector<std::string> kept_builds(const std::string& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& source : fs::directory_iterator(folder)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(source)) {
      if (entry.is_directory()) names.push_back(entry.path().filename().string());
    }
  }
  return names;
}

TEST(History, KeepsAsManyBuildsAsToldTo) {
  const MadeUpProject& project = shared_project();
  std::vector<std::string> arguments = history_arguments(project, "kept.sqlite");
  arguments.insert(arguments.end(),
                   {"--builds", project.file("kept"), "--max-commits", "2", "--keep-builds", "1"});
  const ProgramResult result = project.run(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  const std::vector<std::string> measured = builds_in(project.file("kept.sqlite"));
  ASSERT_EQ(std::set<std::string>(measured.begin(), measured.end()).size(), 2u);
  EXPECT_EQ(kept_builds(project.file("kept")), std::vector<std::string>{measured.back()});
  arguments.back() = "0";
  const ProgramResult again = project.run(arguments);
  EXPECT_NE(again.out.find("0 executed, 2 stored before"), std::string::npos) << again.out << again.err;
  EXPECT_TRUE(kept_builds(project.file("kept")).empty());
  EXPECT_EQ(builds_in(project.file("kept.sqlite")).size(), 4u);
}

// A `git worktree add` that is killed leaves a locked work tree.
TEST(History, ReplacesALockedWorkTree) {
  const MadeUpProject& project = shared_project();
  std::vector<std::string> arguments = history_arguments(project, "locked.sqlite");
  arguments.insert(arguments.end(), {"--builds", project.file("locked"), "--max-commits", "1"});
  ASSERT_EQ(project.run(arguments).exit_code, 0);
  const fs::path tree =
      fs::directory_iterator(project.file("locked"))->path() / kept_builds(project.file("locked")).at(0);
  const std::string lock =
      "git -C '" + project.file("repository") + "' worktree lock '" + tree.string() + "'";
  ASSERT_EQ(std::system(lock.c_str()), 0);
  fs::remove_all(tree);
  fs::remove(fs::path(tree).concat(".built"));
  std::ranges::replace(arguments, project.file("locked.sqlite"), project.file("another.sqlite"));
  const ProgramResult result = project.run(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_EQ(builds_in(project.file("another.sqlite")).size(), 2u);
}

// A repository with the presets of this project, whose program is the replay system.
TEST(History, OfThisOdometryBuildsItsPreset) {
  const MadeUpProject& project = shared_project();
  project.folder().write("own/CMakeLists.txt", R"(cmake_minimum_required(VERSION 3.25)
project(own NONE)
add_custom_target(stillpoint COMMAND ${CMAKE_COMMAND} -E copy ")" STILLPOINT_BINARY_DIR
                                               R"(/tests/replay_program" stillpoint)
)");
  project.folder().write("own/CMakePresets.json", R"({"version": 6, "configurePresets": [
    {"name": "release", "generator": "Ninja", "binaryDir": "${sourceDir}/build/release"}]})");
  project.folder().write("own.toml",
                         "variants = [\"vo\"]\nimages = 0\n[recorded]\nsequences = [\"freiburg1_a\"]\n");
  const std::string git = "GIT_CONFIG_GLOBAL=/dev/null git -C '" + project.file("own") +
                          "' -c user.name=t -c user.email=t@example.org ";
  ASSERT_EQ(std::system((git + "init -q && " + git + "add . && " + git + "commit -qm 1").c_str()), 0);
  const std::string store = project.file("own.sqlite");
  const std::string history =
      shell_command(project, "cd '" + project.file("own") + "' &&",
                    {"history", "HEAD", "--plan", project.file("own.toml"), "--store", store});
  EXPECT_EQ(std::system(history.c_str()), 0) << std::ifstream(project.file("log")).rdbuf();
  const std::vector<bench::StoredRun> runs = bench::Store(store).runs();
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].identity.system, "stillpoint");
  EXPECT_EQ(runs[0].identity.build.size(), 40u);
  EXPECT_EQ(runs[0].outcome, bench::Outcome::kOk) << runs[0].detail;
}

// The keys of all runs have the checksum of the beginning.
TEST(History, EndsWhenASequenceChangesBetweenCommits) {
  const MadeUpProject project;
  project.folder().write("change.sh",
                         "sh build.sh && . ./parameters && [ $NUMBER != 11 ] ||\n  echo '# end' >>'" +
                             project.file("freiburg1_a/groundtruth.txt") + "'\n");
  project.folder().write("changing.toml",
                         "name = \"slam\"\ncommand = [\"{binary}\", \"{sequence}\", \"{out}\", \"1\"]\n"
                         "layout = \"as_is\"\n[source]\ngit = \"repository\"\nbinary = \"out/slam\"\n"
                         "build = [\"sh\", \"" +
                             project.file("change.sh") + "\"]\n");
  std::vector<std::string> arguments = history_arguments(project, "changed.sqlite");
  std::ranges::replace(arguments, project.file("slam.toml"), project.file("changing.toml"));
  arguments.insert(arguments.end(), {"--max-commits", "2"});
  const ProgramResult result = project.run(arguments);
  EXPECT_EQ(result.exit_code, 2) << result.out << result.err;
  EXPECT_NE(result.err.find("groundtruth.txt changed"), std::string::npos) << result.err;
  EXPECT_EQ(builds_in(project.file("changed.sqlite")), std::vector<std::string>(2, project.commit(12)));
}

TEST(History, ReportsWhatIsMissing) {
  const MadeUpProject& project = shared_project();
  const auto history = [&](const std::string& range, const std::string& system) {
    return project.run({"history", range, "--system", project.file(system), "--plan",
                        project.file("plan.toml"), "--store", project.file("runs.sqlite")});
  };
  const ProgramResult range = history("v1..v2", "slam.toml");
  EXPECT_EQ(range.exit_code, 2);
  EXPECT_NE(range.err.find("git: "), std::string::npos) << range.err;
  EXPECT_EQ(history("HEAD..HEAD", "slam.toml").exit_code, 2);
  project.folder().write("other.toml", "name = \"other\"\ncommand = [\"true\"]\n");
  const ProgramResult source = history("HEAD", "other.toml");
  EXPECT_EQ(source.exit_code, 2);
  EXPECT_NE(source.err.find("has no table [source]"), std::string::npos) << source.err;
  project.folder().write("other.toml", "name = \"other\"\ncommand = [\"{binary}\"]\n");
  EXPECT_NE(history("HEAD", "other.toml").err.find("add the table [source]"), std::string::npos);
  EXPECT_FALSE(fs::exists(project.file("runs.sqlite")));
}

struct Planted {
  std::string metric;
  std::size_t commit;
};

TEST(Bisect, FindsEachPlantedCommitInFiveBuilds) {
  const MadeUpProject& project = shared_project();
  for (const Planted& planted :
       {Planted{"ate_rmse_m", 7}, Planted{"tracking", 4}, Planted{"failed_runs", 10}}) {
    const ProgramResult result = project.run(
        {"bisect", planted.metric, project.commit(1) + "..main", "--system", project.file("slam.toml"),
         "--plan", project.file("plan.toml"), "--out", project.file("bisect-" + planted.metric), "--builds",
         project.file("builds-" + planted.metric)});
    EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
    EXPECT_NE(result.out.find("first commit with the change: " + project.commit(planted.commit)),
              std::string::npos)
        << planted.metric << "\n"
        << result.out;
    EXPECT_NE(
        result.out.find("\nconfirmed by its runs and those of its parent; 5 of 12 commits used, 5 built "
                        "now\n"),
        std::string::npos)
        << result.out;
  }
}

TEST(Bisect, OfOneCommitIsNoConfirmationByTheSameRuns) {
  const MadeUpProject& project = shared_project();
  const ProgramResult result = project.run(
      {"bisect", "ate_rmse_m", project.commit(6) + ".." + project.commit(7), "--system",
       project.file("slam.toml"), "--plan", project.file("plan.toml"), "--out", project.file("bisect-one")});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("first commit with the change: " + project.commit(7)), std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("the only commit of the range"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("confirmed"), std::string::npos) << result.out;
}

TEST(Bisect, RejectsAMetricThatTheRunsDoNotHave) {
  const MadeUpProject& project = shared_project();
  const ProgramResult result =
      project.run({"bisect", "ate_rmse", project.commit(1) + ".." + project.commit(7), "--system",
                   project.file("slam.toml"), "--plan", project.file("plan.toml"), "--out",
                   project.file("bisect-unknown")});
  EXPECT_EQ(result.exit_code, 2) << result.out;
  EXPECT_NE(result.err.find("did you mean \"ate_rmse_m\""), std::string::npos) << result.err;
}

TEST(Bisect, SaysThatNothingChanged) {
  const MadeUpProject& project = shared_project();
  const auto bisect = [&](const std::string& range) {
    return project.run({"bisect", "ate_rmse_m", range, "--system", project.file("slam.toml"), "--plan",
                        project.file("plan.toml"), "--out", project.file("bisect"), "--max-pairs", "8"});
  };
  const ProgramResult same = bisect(project.commit(1) + ".." + project.commit(3));
  EXPECT_EQ(same.exit_code, 3) << same.out << same.err;
  EXPECT_NE(same.out.find("ate_rmse_m did not change"), std::string::npos) << same.out;
  const ProgramResult reversed = bisect(project.commit(3) + ".." + project.commit(1));
  EXPECT_EQ(reversed.exit_code, 2);
  EXPECT_NE(reversed.err.find("no ancestor"), std::string::npos) << reversed.err;
  EXPECT_EQ(bisect(project.commit(3)).exit_code, 2);
  const ProgramResult unbuilt = bisect(project.commit(1) + ".." + project.commit(8));
  EXPECT_EQ(unbuilt.exit_code, 2);
  EXPECT_NE(unbuilt.err.find("cannot be built"), std::string::npos) << unbuilt.err;
}

TEST(SystemsRun, ExecutesTheProgramOfTheRepository) {
  const MadeUpProject& project = shared_project();
  const auto run = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"systems",
                                          "run",
                                          project.file("slam.toml"),
                                          project.file("freiburg1_a"),
                                          "--out",
                                          project.file("single")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return project.run(arguments);
  };
  const ProgramResult missing = run({});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.out.find("cannot be started"), std::string::npos) << missing.out << missing.err;
  ASSERT_EQ(std::system(("cd '" + project.file("repository") + "' && sh build.sh").c_str()), 0);
  const ProgramResult result = run({});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("freiburg1_a slam: ok"), std::string::npos) << result.out;
  std::ostringstream json;
  json << std::ifstream(project.file("single/result.json")).rdbuf();
  EXPECT_NE(json.str().find("\"ate_rmse_m\": 0.0"), std::string::npos) << json.str();
  EXPECT_NE(json.str().find("\"peak_memory_mb\""), std::string::npos);
  EXPECT_TRUE(fs::exists(project.file("single/trajectory.tum")));
  EXPECT_NE(json.str().find("\"tracking\""), std::string::npos);
  const ProgramResult parameter = run({"--set", "param.features=5"});
  EXPECT_EQ(parameter.exit_code, 2);
  EXPECT_NE(parameter.err.find("sets no parameter of slam"), std::string::npos) << parameter.err;
  EXPECT_EQ(run({"--fault", "detector_late"}).exit_code, 2);
}

// `history --keep-builds` of another process removes builds that nothing locks.
TEST(CompareSystems, LocksItsBuildsDuringTheRuns) {
  const MadeUpProject& project = shared_project();
  std::ostringstream description;
  description << std::ifstream(project.file("slam.toml")).rdbuf();
  std::string text = description.str();
  const std::string command = "[\"{binary}\", ";
  text.replace(
      text.find(command), command.size(),
      R"(["sh", "-c", "flock -n '{source}.built' true && exit 9; exec \"$0\" \"$@\"", "{binary}", )");
  project.folder().write("locked.toml", text);
  const ProgramResult result =
      project.run({"compare", project.file("locked.toml@") + project.commit(1),
                   project.file("locked.toml@") + project.commit(2), "--plan", project.file("plan.toml"),
                   "--pairs", "1", "--store", project.file("locked_gate.sqlite")});
  EXPECT_EQ(result.out.find("exited with code 9"), std::string::npos) << result.out << result.err;
  for (const bench::StoredRun& run : bench::Store(project.file("locked_gate.sqlite")).runs())
    EXPECT_EQ(run.outcome, bench::Outcome::kOk) << run.detail;
}

TEST(CompareSystems, OfCommitsAreBuiltAndCompared) {
  const MadeUpProject& project = shared_project();
  const auto compare = [&](std::size_t base, std::size_t head, const ProgramOptions& options = {}) {
    return project.run({"compare", project.file("slam.toml@") + project.commit(base),
                        project.file("slam.toml@") + project.commit(head), "--plan",
                        project.file("plan.toml"), "--pairs", "8", "--store", project.file("gate.sqlite")},
                       options);
  };
  const ProgramResult interrupted = compare(6, 7, {.interrupt_after = "8 pairs of each"});
  EXPECT_EQ(interrupted.exit_code, 130) << interrupted.out << interrupted.err;
  EXPECT_NE(interrupted.err.find("run the same command again"), std::string::npos) << interrupted.err;
  const ProgramResult worse = compare(6, 7);
  EXPECT_EQ(worse.exit_code, 1) << worse.out << worse.err;
  EXPECT_NE(worse.out.find("| ate_rmse_m"), std::string::npos) << worse.out;
  EXPECT_NE(compare(5, 6).exit_code, 1);  // the same base build name must not reuse the runs of commit 6
  const ProgramResult unbuilt = compare(7, 8);
  EXPECT_EQ(unbuilt.exit_code, 2);
  EXPECT_NE(unbuilt.err.find("the build failed"), std::string::npos) << unbuilt.err;
}

}  // namespace
}  // namespace stillpoint
