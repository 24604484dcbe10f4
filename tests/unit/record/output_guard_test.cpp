// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/output_folder.h"

#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(OutputGuard, WritesANewFileAndFillsAnEmptyOne) {
  const TemporaryFolder folder;
  write_output(folder.path() / "new" / "a.svg", "<svg>", {.beginning = "<svg"});
  EXPECT_EQ(text_of(folder.path() / "new" / "a.svg"), "<svg>");
  const fs::path empty = folder.write("empty.svg", "");
  write_output(empty, "<svg>", {.beginning = "<svg"});
  EXPECT_EQ(text_of(empty), "<svg>");
}

TEST(OutputGuard, ReplacesAFileOfTheSameKindOnlyWithForce) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("a.svg", "<svg>old");
  expect_input_error([&] { write_output(file, "<svg>new", {.force = false, .beginning = "<svg"}); },
                     {"a.svg: already exists", "--force"});
  // Of a command without that option.
  expect_input_error([&] { write_output(file, "<svg>new", {.beginning = "<svg"}); },
                     {"a.svg: already exists; remove it or choose another name"});
  EXPECT_EQ(text_of(file), "<svg>old");
  write_output(file, "<svg>new", {.force = true, .beginning = "<svg"});
  EXPECT_EQ(text_of(file), "<svg>new");
}

TEST(OutputGuard, NeverReplacesAFileOfAnotherKind) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("a.svg", "1.0 2 3");
  for (const bool force : {false, true})
    expect_input_error([&] { write_output(file, "<svg>", {.force = force, .beginning = "<svg"}); },
                       {"is a file of another kind"});
  EXPECT_EQ(text_of(file), "1.0 2 3");
}

TEST(OutputGuard, NeverReplacesAnInput) {
  const TemporaryFolder folder;
  const fs::path input = folder.write("gt.txt", "<svg>");
  fs::create_symlink(input, folder.path() / "link");
  fs::create_hard_link(input, folder.path() / "hard");
  fs::create_directory(folder.path() / "sub");
  for (const fs::path& output :
       {input, folder.path() / "link", folder.path() / "hard", folder.path() / "sub" / ".." / "gt.txt"}) {
    expect_input_error(
        [&] {
          write_output(output, "<svg>", {.inputs = {"", input}, .force = true, .beginning = "<svg"});
        },
        {"is an input"});
  }
  const fs::path missing = folder.path() / "missing";
  expect_input_error(
      [&] { require_safe_output(folder.path() / "sub" / ".." / "missing", {.inputs = {missing}}); },
      {"is an input"});
}

TEST(OutputGuard, FollowsLinksToTheirTarget) {
  const TemporaryFolder folder;
  fs::create_symlink(folder.path() / "target.svg", folder.path() / "link.svg");
  write_output(folder.path() / "link.svg", "<svg>", {.beginning = "<svg"});
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link.svg"));
  EXPECT_EQ(text_of(folder.path() / "target.svg"), "<svg>");
}

TEST(OutputGuard, RejectsDevicesPipesAndFolders) {
  const TemporaryFolder folder;
  const std::string pipe = (folder.path() / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& output : {pipe, std::string("/dev/null"), folder.path().string()})
    expect_input_error([&] { write_output(output, "x", {.force = true}); }, {output + ": is a "});
}

const OutputLayout kLayout = {.names = {"index.html", "table.csv", "images"},
                              .marks = {{"index.html", "table.csv"}}};

TEST(OutputGuard, AcceptsNewFoldersAndThoseOfEarlierOutputs) {
  const TemporaryFolder folder;
  require_safe_folder(folder.path() / "new", kLayout, {});
  folder.write("out/notes.txt", "");
  require_safe_folder(folder.path() / "out", kLayout, {});
  folder.write("out/index.html", "");
  folder.write("out/table.csv", "");
  folder.write("out/images/1.jpg", "");
  require_safe_folder(folder.path() / "out", kLayout, {});
}

TEST(OutputGuard, RefusesFoldersWithFilesOfAnotherOrigin) {
  const TemporaryFolder folder;
  folder.write("site/index.html", "");
  expect_input_error([&] { require_safe_folder(folder.path() / "site", kLayout, {}); },
                     {"site/index.html: exists, but not as part of an earlier output"});
  folder.write("photos/images/1.jpg", "");
  expect_input_error([&] { require_safe_folder(folder.path() / "photos", kLayout, {}); }, {"photos/images"});
}

TEST(OutputGuard, RefusesInputFoldersAndFoldersOfInputs) {
  const TemporaryFolder folder;
  expect_input_error([&] { require_safe_folder(folder.path() / ".", kLayout, {folder.path()}); },
                     {"is an input"});
  folder.write("index.html", "");
  folder.write("table.csv", "");
  expect_input_error([&] { require_safe_folder(folder.path(), kLayout, {folder.path() / "table.csv"}); },
                     {"table.csv: is an input"});
}

}  // namespace
}  // namespace stillpoint::bench
