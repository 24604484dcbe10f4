// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/source_builds.h"

#include <gtest/gtest.h>

#include <sys/time.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// A repository without a commit, and the beginning of git commands for it.
std::string empty_repository(const fs::path& repository) {
  fs::create_directories(repository);
  std::string git =
      "GIT_CONFIG_GLOBAL=/dev/null git -C '" + repository.string() + "' -c user.name=a -c user.email=b ";
  EXPECT_EQ(std::system((git + "init -q -b main").c_str()), 0);
  return git;
}

/// Adds a commit for each minute of the hour of its date.
void add_commits(const std::string& git, const std::vector<int>& minutes) {
  for (std::size_t i = 0; i < minutes.size(); ++i) {
    const std::string date = "GIT_COMMITTER_DATE=2024-01-01T00:" + std::to_string(minutes[i]) + ":00Z ";
    const std::string commit = "commit -q --allow-empty -m " + std::to_string(i);
    ASSERT_EQ(std::system((date + git + commit).c_str()), 0);
  }
}

std::string subjects(const std::vector<SourceCommit>& commits) {
  std::string text;
  for (const SourceCommit& commit : commits) text += commit.subject;
  return text;
}

const SystemSource kTouchingSource{.git = ".", .build = {"touch", "program"}, .binary = "program"};

TEST(SourceBuilds, AreOfTheCommitsNearestToTheEndOfTheRangeWhateverTheirDates) {
  const TemporaryFolder folder;
  const fs::path repository = folder.path() / "repository";
  add_commits(empty_repository(repository), {10, 10, 10, 40, 20, 30, 50});
  const SourceBuilds builds(kTouchingSource, repository, folder.path() / "builds", {});
  EXPECT_EQ(subjects(builds.commits("HEAD~4", 2)), "21");
  EXPECT_EQ(subjects(builds.commits("HEAD")), "6543210");
  EXPECT_EQ(builds.commits("HEAD").at(2).time, "2024-01-01T00:40:01Z");  // dated before its parent 3
  // 1 and 2 have the time of 0, also in a range that does not contain it.
  EXPECT_EQ(builds.commits("HEAD").at(4).time, "2024-01-01T00:10:02Z");
  EXPECT_EQ(builds.commits("HEAD~4", 1).at(0).time, "2024-01-01T00:10:02Z");
}

TEST(SourceBuilds, NameWhatAShallowCloneLacks) {
  const TemporaryFolder folder;
  const fs::path repository = folder.path() / "repository";
  const std::string git = empty_repository(repository);
  add_commits(git, {10, 20, 30, 40});
  ASSERT_EQ(std::system((git + "tag v1 HEAD~3").c_str()), 0);
  const fs::path clone = folder.path() / "clone";
  const std::string command = "git clone -q --depth 2 'file://" + repository.string() + "' '" +
                              clone.string() + "' && git -C '" + clone.string() +
                              "' fetch -q --depth 1 origin tag v1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const SourceBuilds builds(kTouchingSource, clone, folder.path() / "builds", {});
  expect_input_error([&] { static_cast<void>(builds.commits("v0..HEAD")); },
                     {"bad revision 'v0..HEAD'", "--unshallow"});
  expect_input_error([&] { static_cast<void>(builds.between(builds.commit("v1"), builds.commit("HEAD"))); },
                     {"no ancestor", "--unshallow"});
}

/// Stems of the files, or the folders, with an ending, sorted.
std::vector<std::string> stems(const fs::path& folder, const std::string& ending) {
  std::vector<std::string> names;
  for (const fs::directory_entry& source : fs::directory_iterator(folder)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(source)) {
      if (ending.empty() ? entry.is_directory() : entry.path().extension() == ending)
        names.push_back(entry.path().stem().string());
    }
  }
  std::ranges::sort(names);
  return names;
}

TEST(SourceBuilds, KeepsThoseInUseAndNotThoseThatFailed) {
  const TemporaryFolder folder;
  const fs::path repository = folder.path() / "repository";
  const std::string git = empty_repository(repository);
  const auto commit_file = [&](const char* name) {
    folder.write(std::string("repository/") + name, "");
    return std::system((git + "add -A && " + git + "commit -q -m change").c_str());
  };
  ASSERT_EQ(commit_file("works"), 0);
  ASSERT_EQ(commit_file("fails"), 0);

  const fs::path kept = folder.path() / "builds";
  const SystemSource source{
      .git = ".", .build = {"sh", "-c", "test ! -e fails && touch program"}, .binary = "program"};
  const SourceBuilds builds(source, repository, kept, {});
  const SourceCommit works = builds.commit("HEAD~1"), fails = builds.commit("HEAD");
  {
    const SourceBuild used = builds.build(works);
    EXPECT_EQ(used.failure, "");
    EXPECT_NE(builds.build(fails).failure.find("the build failed"), std::string::npos);
    EXPECT_EQ(builds.keep_latest(0), 1u);
    EXPECT_EQ(stems(kept, ""), std::vector<std::string>{works.hash});
  }
  EXPECT_NE(builds.build(fails).failure, "");
  EXPECT_EQ(builds.keep_latest(1), 1u) << "the failed one, though it is the latest";
  EXPECT_EQ(stems(kept, ""), std::vector<std::string>{works.hash});
  EXPECT_EQ(builds.keep_latest(0), 1u);
  EXPECT_TRUE(stems(kept, "").empty());
  EXPECT_EQ(stems(kept, ".log"), std::vector<std::string>{fails.hash}) << "tells why it failed";
}

extern "C" void ignore_signal(int) {}

/// Interrupts system calls of this process every millisecond.
class Interruptions {
 public:
  Interruptions() {
    struct sigaction action {};
    action.sa_handler = ignore_signal;  // without SA_RESTART
    sigaction(SIGALRM, &action, &previous_);
    set_interval_us(1000);
  }
  ~Interruptions() {
    set_interval_us(0);
    sigaction(SIGALRM, &previous_, nullptr);
  }
  Interruptions(const Interruptions&) = delete;
  Interruptions& operator=(const Interruptions&) = delete;

 private:
  static void set_interval_us(suseconds_t interval_us) {
    const itimerval timer{.it_interval = {0, interval_us}, .it_value = {0, interval_us}};
    setitimer(ITIMER_REAL, &timer, nullptr);
  }
  struct sigaction previous_ {};
};

// As of another `history` that builds a commit for minutes.
TEST(SourceBuilds, StopToWaitForAnotherProcess) {
  const TemporaryFolder folder;
  const fs::path repository = folder.path() / "repository";
  add_commits(empty_repository(repository), {10});
  bool is_stopped = false;
  const SourceBuilds builds(kTouchingSource, repository, folder.path() / "builds",
                            [&is_stopped] { return is_stopped; });
  ASSERT_EQ(builds.build(builds.commit("HEAD")).failure, "");
  EXPECT_FALSE(builds.is_busy());
  const FileLock other(fs::directory_iterator(folder.path() / "builds")->path() / "lock",
                       LockKind::kExclusive);
  EXPECT_TRUE(builds.is_busy());
  const SourceCommit commit = builds.commit("HEAD");
  const Interruptions interruptions;
  is_stopped = true;
  EXPECT_EQ(builds.build(commit).failure, "stopped");
}

}  // namespace
}  // namespace stillpoint::bench
