// SPDX-License-Identifier: BSD-3-Clause
// Stores that cannot be used say so, and lose nothing.
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bench/store/journal.h"
#include "bench/store/schema.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

RunIdentity identity_of(std::int64_t repetition) {
  return {.variant = "vo", .sequence = "office", .repetition = repetition};
}

/// A store with one run in it.
fs::path small_store(const TemporaryFolder& folder) {
  fs::path file = folder.path() / "store.sqlite";
  Journal journal(file);
  static_cast<void>(journal.claim(identity_of(1)));
  journal.finish(identity_of(1), {.outcome = Outcome::kOk, .attachments = {{"log", "text"}}});
  return file;
}

TEST(StoreFaults, AMissingStoreIsNotMadeByReading) {
  expect_input_error([] { const Store store("no/such/store.sqlite"); }, {"there is no such store"});
}

TEST(StoreFaults, AFileOfAnotherKindIsRefused) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("notes.txt", std::string(5000, 'n'));
  expect_input_error([&] { const Journal journal(file); }, {"notes.txt", "not a database"});
  EXPECT_EQ(fs::file_size(file), 5000u);
}

TEST(StoreFaults, AnotherProgramsDatabaseIsRefused) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "other.sqlite";
  Database(file, DatabaseAccess::kWrite).execute("CREATE TABLE holiday (day TEXT)");
  expect_input_error([&] { const Journal journal(file); }, {"another program's database"});
}

TEST(StoreFaults, ANewerSchemaIsRefusedForReadingAndWriting) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder);
  const std::string newer = std::to_string(schema_version() + 1);
  Database(file, DatabaseAccess::kWrite).execute("PRAGMA user_version = " + newer);
  const std::vector<std::string> parts = {"newer version", "schema " + newer};
  expect_input_error([&] { const Store store(file); }, parts);
  expect_input_error([&] { const Journal journal(file); }, parts);
}

TEST(StoreFaults, ADamagedStoreIsRefusedBeforeAnythingIsAdded) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder);
  {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(4096);  // the second page, a table's
    stream << std::string(4096, '\xff');
  }
  expect_input_error([&] { const Journal journal(file); }, {"store.sqlite", "damaged"});
}

/// Runs a check as someone who may only read, in a process of its own; true if it holds.
template <class Check>
bool holds_for_a_reader(const TemporaryFolder& folder, const fs::path& file, const Check& check) {
  constexpr uid_t kNobody = 65534;
  fs::permissions(file, fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
  fs::permissions(folder.path(), fs::perms(0555));
  const pid_t child = fork();
  if (child == 0) _exit((geteuid() != 0 || setuid(kNobody) == 0) && check() ? 0 : 1);
  int status = 0;
  waitpid(child, &status, 0);
  fs::permissions(folder.path(), fs::perms::owner_all);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(StoreFaults, AStoreWithoutWritePermissionCanBeRead) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder);
  EXPECT_TRUE(holds_for_a_reader(folder, file, [&] { return Store(file).runs().size() == 1; }));
}

TEST(StoreFaults, AStoreWithoutWritePermissionIsNotFilled) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder);
  EXPECT_TRUE(holds_for_a_reader(folder, file, [&] {
    try {
      const Journal journal(file);
      return false;
    } catch (const InputError& error) {
      return std::string(error.what()).find("may only be read") != std::string::npos;
    }
  }));
}

/// Adds runs in a process whose files may not grow any more, as on a full disk; true if it ended with an
/// error.
bool fills_the_disk(const fs::path& file) {
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{200'000, 200'000};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      Journal journal(file);
      for (std::int64_t i = 2; i < 5000; ++i) {
        static_cast<void>(journal.claim(identity_of(i)));
        journal.finish(identity_of(i), {.detail = std::string(2000, 'x')});
      }
    } catch (const InputError& error) {
      _exit(std::string(error.what()).find("free space") != std::string::npos ? 2 : 1);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 2;
}

TEST(StoreFaults, AFullDiskLosesNoStoredRun) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder);
  EXPECT_TRUE(fills_the_disk(file));
  const std::vector<StoredRun> kept = Store(file).runs();
  EXPECT_GT(kept.size(), 1u);
  EXPECT_EQ(Store(file).attachment(kept.front(), "log"), "text");
  Journal journal(file);  // space again: the next run is taken up where it broke off
  EXPECT_EQ(journal.claim(identity_of(static_cast<std::int64_t>(kept.size()) + 1)), Claim::kGranted);
}

}  // namespace
}  // namespace stillpoint
