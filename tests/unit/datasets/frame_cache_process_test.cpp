// SPDX-License-Identifier: BSD-3-Clause
// The frame cache with several processes, killed processes and full disks.
#include <gtest/gtest.h>

#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "tests/support/sequences/cached_sequence.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

constexpr int kSuccess = 0;
constexpr int kNoMount = 77;

FrameCacheOptions options_for(const fs::path& cache) {
  return {.folder = cache, .max_bytes = 10'000'000, .disk_reserve_bytes = 0};
}

/// Runs `work` in a child process. @return its pid
template <class Work>
pid_t start(const Work& work) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work());
  return child;
}

/// @return status as of waitpid
int wait_for(pid_t child) {
  int status = -1;
  ::waitpid(child, &status, 0);
  return status;
}

/// Loads all frames. @return kSuccess if they are right and there were `warnings` warnings
int load_all(const fs::path& sequence, const fs::path& cache, std::size_t warnings = 0) {
  CachedSequence opened(sequence, options_for(cache));
  return opened.loads_all() && opened.warnings.size() == warnings ? kSuccess : 1;
}

TEST(FrameCacheProcesses, ProcessesThatStartTogetherWriteOneFile) {
  const TemporaryFolder folder;
  const fs::path cache = folder.path() / "cache";
  const fs::path sequence = noise_sequence(folder.path() / "a");
  std::vector<pid_t> children;
  for (int i = 0; i < 4; ++i) children.push_back(start([&] { return load_all(sequence, cache); }));
  for (const pid_t child : children) EXPECT_EQ(wait_for(child), kSuccess);
  EXPECT_EQ(cache_files(cache).size(), 1U);
  EXPECT_TRUE(cache_files(cache, ".partial").empty());
  EXPECT_TRUE(CachedSequence(sequence, options_for(cache)).cache.complete());
}

TEST(FrameCacheProcesses, ASecondProcessDecodesWhileTheFirstWrites) {
  const TemporaryFolder folder;
  const fs::path cache = folder.path() / "cache";
  const fs::path sequence = noise_sequence(folder.path() / "a");
  CachedSequence writing(sequence, options_for(cache));
  EXPECT_TRUE(writing.loads_same(0));
  CachedSequence second(sequence, options_for(cache));
  EXPECT_TRUE(second.loads_all());
  EXPECT_EQ(second.decoded, kCachedFrames);
  EXPECT_TRUE(cache_files(cache).empty());
  EXPECT_TRUE(writing.loads_all());
  EXPECT_EQ(cache_files(cache).size(), 1U);
}

TEST(FrameCacheProcesses, AKilledWriterLeavesNoFileThatIsUsed) {
  const TemporaryFolder folder;
  const fs::path cache = folder.path() / "cache";
  const fs::path sequence = noise_sequence(folder.path() / "a");
  const pid_t child = start([&] {
    CachedSequence opened(sequence, options_for(cache));
    for (std::size_t i = 0; i < 3; ++i) static_cast<void>(opened.loads_same(i));
    ::raise(SIGKILL);
    return 1;
  });
  const int status = wait_for(child);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  EXPECT_EQ(cache_files(cache, ".partial").size(), 1U);
  EXPECT_TRUE(cache_files(cache).empty());
  EXPECT_EQ(load_all(sequence, cache), kSuccess);
  EXPECT_TRUE(cache_files(cache, ".partial").empty());
  EXPECT_TRUE(CachedSequence(sequence, options_for(cache)).cache.complete());
}

TEST(FrameCacheProcesses, ALimitOfTheFileSizeEndsTheCacheButNotTheRun) {
  const TemporaryFolder folder;
  const fs::path cache = folder.path() / "cache";
  const fs::path sequence = noise_sequence(folder.path() / "a");
  const pid_t child = start([&] {
    const rlimit limit{.rlim_cur = 30'000, .rlim_max = 30'000};
    return ::setrlimit(RLIMIT_FSIZE, &limit) == 0 ? load_all(sequence, cache, 1) : 1;
  });
  EXPECT_EQ(wait_for(child), kSuccess);
  EXPECT_TRUE(cache_files(cache).empty());
  EXPECT_TRUE(cache_files(cache, ".partial").empty());
}

TEST(FrameCacheProcesses, AFullDiskEndsTheCacheButNotTheRun) {
  const TemporaryFolder folder;
  const fs::path disk = folder.path() / "disk";
  fs::create_directories(disk);
  const fs::path sequence = noise_sequence(folder.path() / "a");
  const pid_t child = start([&] {  // a mount that ends with the process
    if (::unshare(CLONE_NEWNS) != 0 || ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0)
      return kNoMount;
    if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=32k") != 0) return kNoMount;
    const bool without_cache = load_all(sequence, disk, 1) == kSuccess && cache_files(disk).empty();
    return without_cache && cache_files(disk, ".partial").empty() ? kSuccess : 1;
  });
  const int status = wait_for(child);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNoMount)
    GTEST_SKIP() << "no permission to mount a small disk";
  EXPECT_EQ(status, kSuccess);
}

}  // namespace
}  // namespace stillpoint::datasets
