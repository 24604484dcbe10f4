// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/output_folder.h"

#include <csignal>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::size_t entries_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

/// Limits the size of files that this process writes, which simulates a full disk, during its lifetime.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_limit_);
    const rlimit limit{bytes, old_limit_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*old_handler_)(int);
  rlimit old_limit_{};
};

TEST(OutputFolder, CreatesTheFolderAndReplacesOldFiles) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "a" / "b";
  write_files(out, {{"one", "old"}});
  write_files(out, {{"one", "1"}, {"two", "2"}});
  EXPECT_EQ(text_of(out / "one"), "1");
  EXPECT_EQ(text_of(out / "two"), "2");
  EXPECT_EQ(entries_in(out), 2u);
}

TEST(OutputFolder, LeavesNoNewFilesOnAFullDisk) {
  const TemporaryFolder folder;
  write_files(folder.path(), {{"small", "old"}});
  {
    const FullDisk full(100);
    expect_input_error(
        [&] {
          write_files(folder.path(), {{"small", "new"}, {"large", std::string(1000, 'x')}});
        },
        {"large: cannot be written: File too large", "output folder"});
  }
  EXPECT_EQ(text_of(folder.path() / "small"), "old");
  EXPECT_EQ(entries_in(folder.path()), 1u);
}

TEST(OutputFolder, RejectsAFolderThatCannotBeCreated) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("file", "");
  expect_input_error([&] { require_writable(file / "below"); },
                     {(file / "below").string() + ": cannot be created", "output folder"});
}

TEST(OutputFolder, CheckLeavesNoFiles) {
  const TemporaryFolder folder;
  require_writable(folder.path() / "not" / "yet");
  EXPECT_EQ(entries_in(folder.path()), 0u);
}

}  // namespace
}  // namespace stillpoint::bench
