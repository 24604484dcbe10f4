// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/image_list.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

std::vector<StampedFile> stamps_ms(std::initializer_list<std::int64_t> times) {
  std::vector<StampedFile> files;
  for (const std::int64_t t : times) files.push_back(StampedFile{.t = Timestamp{t * 1'000'000}, .file = {}});
  return files;
}

TEST(Associate, PairsTheNearestFirstAndEachIndexOnce) {
  // 33 is nearer to 30 (3 ms) than 20 is (10 ms), so 20 is paired with 5; in order of time it would be 30.
  EXPECT_EQ(associate(stamps_ms({20, 33}), stamps_ms({5, 30}), 0.02), (Pairs{{0, 0}, {1, 1}}));
  EXPECT_EQ(associate(stamps_ms({20, 30}), stamps_ms({29}), 0.02), (Pairs{{1, 0}}));
}

TEST(Associate, TheMaximumDifferenceIsInclusive) {
  EXPECT_EQ(associate(stamps_ms({0, 100}), stamps_ms({20, 121}), 0.02), (Pairs{{0, 0}}));
  EXPECT_TRUE(associate(stamps_ms({}), stamps_ms({1}), 0.02).empty());
}

TEST(ImageList, PathsAreRelativeToTheList) {
  const TemporaryFolder folder;
  FaultLog strict;
  const auto list = read_image_list(folder.write("rgb.txt", "# list\n1.5 rgb/a.png\n"), strict);
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].t, Timestamp{1'500'000'000});
  EXPECT_EQ(list[0].file, folder.path() / "rgb/a.png");
}

TEST(ImageList, EmptyAndUnsortedListsAreErrors) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    return [&folder, text] {
      FaultLog strict;
      static_cast<void>(read_image_list(folder.write("rgb.txt", text), strict));
    };
  };
  expect_input_error(read("# nothing\n"), {"rgb.txt", "no images"});
  expect_input_error(read("2 a.png\n1 b.png\n"), {"rgb.txt:2", "sort the file"});
  expect_input_error(read("2\n"), {"rgb.txt:1", "field"});
}

}  // namespace
}  // namespace stillpoint::datasets
