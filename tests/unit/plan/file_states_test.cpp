// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/file_states.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

TEST(SequenceWatch, NamesChangedFilesButNoHiddenOnes) {
  const TemporaryFolder folder;
  folder.write("seq/imu.txt", "1\n");
  SequenceWatch watch;
  EXPECT_EQ(watch.changes_of(folder.path() / "seq"), "");
  folder.write("seq/.nfs0001", "x");
  folder.write("seq/rgb/.1.png.swp", "x");
  EXPECT_EQ(watch.changes_of(folder.path() / "seq"), "");
  folder.write("seq/imu.txt", "1 2\n");
  folder.write("seq/rgb/2.png", "x");
  EXPECT_EQ(watch.changes_of(folder.path() / "seq"), "seq/imu.txt changed, seq/rgb/2.png new");
}

}  // namespace
}  // namespace stillpoint::bench
