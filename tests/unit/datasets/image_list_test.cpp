// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/formats/image_lists.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

TEST(ImageList, PathsAreRelativeToTheRoot) {
  const TemporaryFolder folder;
  FaultLog strict;
  const auto list = read_image_list(folder.write("rgb.txt", "# list\n1.5 rgb/a.png\n"), folder.path(),
                                    eval::TimeUnit::kSeconds, strict);
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].t, Timestamp{1'500'000'000});
  EXPECT_EQ(list[0].file, folder.path() / "rgb/a.png");
}

TEST(ImageList, PathsOfExistingImagesMayContainBlanks) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "my rgb");
  folder.write("my rgb/a.png", "");
  folder.write("b.png", "");
  FaultLog strict;
  const auto list = read_image_list(folder.write("rgb.txt", "1.5 my rgb/a.png\n1.6 b.png 0.01\n"),
                                    folder.path(), eval::TimeUnit::kSeconds, strict);
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].file, folder.path() / "my rgb/a.png");
  EXPECT_EQ(list[1].file, folder.path() / "b.png");
}

TEST(ImageList, BackslashesSeparateFolders) {
  const TemporaryFolder folder;
  folder.write("kept\\b.png", "");  // some programs extract archives of Windows to such names
  FaultLog strict;
  const auto list = read_image_list(folder.write("rgb.txt", "1.5 rgb\\a.png\n1.6 kept\\b.png\n"),
                                    folder.path(), eval::TimeUnit::kSeconds, strict);
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].file, folder.path() / "rgb/a.png");
  EXPECT_EQ(list[1].file, folder.path() / "kept\\b.png");
}

TEST(ImageList, EmptyAndUnsortedListsAreErrors) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    return [&folder, text] {
      FaultLog strict;
      static_cast<void>(
          read_image_list(folder.write("rgb.txt", text), folder.path(), eval::TimeUnit::kSeconds, strict));
    };
  };
  expect_input_error(read("# nothing\n"), {"rgb.txt", "no images"});
  expect_input_error(read("2 a.png\n1 b.png\n"), {"rgb.txt:2", "sort the file"});
  expect_input_error(read("2\n"), {"rgb.txt:1", "field"});
}

}  // namespace
}  // namespace stillpoint::datasets
