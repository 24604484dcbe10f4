// SPDX-License-Identifier: BSD-3-Clause
// Unusable stores are reported, and no stored run is lost.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <future>
#include <thread>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bench/store/schema.h"
#include "bench/store/store_writer.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

RunIdentity identity_of(std::int64_t repetition) {
  return {.variant = "vo", .sequence = "office", .repetition = repetition};
}

/// A store with one run in it.
fs::path small_store(const TemporaryFolder& folder) {
  fs::path file = folder.path() / "store.sqlite";
  StoreWriter writer(file);
  static_cast<void>(writer.acquire(identity_of(1)));
  writer.finish(identity_of(1), {.outcome = Outcome::kOk, .attachments = {{"log", "text"}}});
  return file;
}

TEST(StoreFaults, ReadingAMissingStoreDoesNotCreateIt) {
  expect_input_error([] { const Store store("no/such/store.sqlite"); }, {"there is no such store"});
}

/// The last worker that leaves a store locks it, also against readers, while it empties its log.
TEST(StoreFaults, AReaderWaitsForAWorkerThatClosesTheStore) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder);
  std::promise<void> locked;
  std::thread closing([&] {
    const Database database(file, DatabaseAccess::kWrite);
    database.execute("PRAGMA locking_mode = EXCLUSIVE; BEGIN IMMEDIATE; COMMIT");
    locked.set_value();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  });
  locked.get_future().wait();
  EXPECT_NO_THROW(static_cast<void>(Store(file).runs()));
  closing.join();
}

TEST(StoreFaults, AFileOfAnotherKindIsRejected) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("notes.txt", std::string(5000, 'n'));
  expect_input_error([&] { const StoreWriter writer(file); }, {"notes.txt", "not a database"});
  EXPECT_EQ(fs::file_size(file), 5000u);
}

TEST(StoreFaults, ADeviceIsRejected) {
  expect_input_error([] { const StoreWriter writer("/dev/null"); }, {"/dev/null: is a device"});
}

TEST(StoreFaults, TheDatabaseOfAnotherProgramIsRejected) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "other.sqlite";
  Database(file, DatabaseAccess::kWrite).execute("CREATE TABLE holiday (day TEXT)");
  expect_input_error([&] { const StoreWriter writer(file); }, {"another program's database"});
}

TEST(StoreFaults, ANewerSchemaIsRejectedForReadingAndWriting) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder);
  const std::string newer = std::to_string(schema_version() + 1);
  Database(file, DatabaseAccess::kWrite).execute("PRAGMA user_version = " + newer);
  const std::vector<std::string> parts = {"newer version", "schema " + newer};
  expect_input_error([&] { const Store store(file); }, parts);
  expect_input_error([&] { const StoreWriter writer(file); }, parts);
}

TEST(StoreFaults, ADamagedStoreIsRejectedBeforeAnythingIsAdded) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder);
  {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(4096);  // the second page, a table's
    stream << std::string(4096, '\xff');
  }
  expect_input_error([&] { const StoreWriter writer(file); }, {"store.sqlite", "damaged"});
}

/// Runs a check in a child process without write permission; returns its result.
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

TEST(StoreFaults, AStoreWithoutWritePermissionCannotBeWritten) {
  const TemporaryFolder folder;
  const fs::path file = small_store(folder);
  EXPECT_TRUE(holds_for_a_reader(folder, file, [&] {
    try {
      const StoreWriter writer(file);
      return false;
    } catch (const InputError& error) {
      return std::string(error.what()).find("is read-only") != std::string::npos;
    }
  }));
}

/// Adds runs in a child process with a file size limit, which simulates a full disk; true if it reported an
/// error.
bool fills_the_disk(const fs::path& file) {
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{200'000, 200'000};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      StoreWriter writer(file);
      for (std::int64_t i = 2; i < 5000; ++i) {
        static_cast<void>(writer.acquire(identity_of(i)));
        writer.finish(identity_of(i), {.detail = std::string(2000, 'x')});
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
  const std::vector<StoredRun> stored = Store(file).runs();
  EXPECT_GT(stored.size(), 1u);
  EXPECT_EQ(Store(file).attachment(stored.front(), "log"), "text");
  StoreWriter writer(file);  // without the limit: continues with the next run
  EXPECT_EQ(writer.acquire(identity_of(static_cast<std::int64_t>(stored.size()) + 1)), RunLease::kGranted);
}

}  // namespace
}  // namespace stillpoint::bench
