// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/sequence_checksum.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace stillpoint::bench
