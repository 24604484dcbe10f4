// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/source_builds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

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
  const std::string git = "git -C '" + repository.string() + "' -c user.name=a -c user.email=b ";
  const auto commit_file = [&](const char* name) {
    folder.write(std::string("repository/") + name, "");
    return std::system((git + "add -A && " + git + "commit -q -m change").c_str());
  };
  fs::create_directories(repository);
  ASSERT_EQ(std::system((git + "init -q").c_str()), 0);
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

}  // namespace
}  // namespace stillpoint::bench
