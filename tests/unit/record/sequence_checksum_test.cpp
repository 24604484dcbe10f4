// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/sequence_checksum.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

std::string checksum_of(const std::string& name, const std::string& text) {
  const TemporaryFolder folder;
  folder.write("a/1.png", "pixels");
  folder.write(name, text);
  return sequence_checksum(folder.path());
}

TEST(SequenceChecksum, DoesNotDependOnTheLocationOfTheFolder) {
  EXPECT_EQ(checksum_of("b.txt", "1"), checksum_of("b.txt", "1"));
}

TEST(SequenceChecksum, DependsOnContentsAndNames) {
  EXPECT_NE(checksum_of("b.txt", "1"), checksum_of("b.txt", "2"));
  EXPECT_NE(checksum_of("b.txt", "1"), checksum_of("c.txt", "1"));
}

class RememberedChecksum : public ::testing::Test {
 protected:
  RememberedChecksum() { write("a.png", "pixels"); }

  /// Writes a file that was modified an hour ago: newer ones are not remembered.
  void write(const std::string& name, const std::string& text) const {
    const auto file = sequence_.write(name, text);
    std::filesystem::last_write_time(file,
                                     std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  }
  [[nodiscard]] std::string remembered() const {
    return remembered_checksum(sequence_.path(), cache_.path() / "new");
  }

  TemporaryFolder sequence_;
  TemporaryFolder cache_;
};

TEST_F(RememberedChecksum, IsThatOfTheFolderAfterEveryChange) {
  EXPECT_EQ(remembered(), sequence_checksum(sequence_.path()));
  EXPECT_EQ(remembered(), sequence_checksum(sequence_.path()));
  write("a.png", "other, longer");
  EXPECT_EQ(remembered(), sequence_checksum(sequence_.path()));
  write("b.png", "new");
  EXPECT_EQ(remembered(), sequence_checksum(sequence_.path()));
}

TEST_F(RememberedChecksum, ASecondCallReadsNoFile) {
  const std::string before = remembered();
  const auto file = sequence_.path() / "a.png";
  const auto time = std::filesystem::last_write_time(file);
  std::fstream(file, std::ios::in | std::ios::out) << "PIXELS";  // the same size
  std::filesystem::last_write_time(file, time);
  EXPECT_EQ(remembered(), before);
}

TEST_F(RememberedChecksum, ADamagedMemoryIsIgnored) {
  static_cast<void>(remembered());
  for (const auto& entry : std::filesystem::directory_iterator(cache_.path() / "new"))
    std::fstream(entry.path(), std::ios::in | std::ios::out).seekp(20) << "0000";
  EXPECT_EQ(remembered(), sequence_checksum(sequence_.path()));
}

TEST_F(RememberedChecksum, WorksWithoutACache) {
  EXPECT_EQ(remembered_checksum(sequence_.path(), {}), sequence_checksum(sequence_.path()));
}

}  // namespace
}  // namespace stillpoint::bench
