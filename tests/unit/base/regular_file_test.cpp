// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/error.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

TEST(RegularFile, AcceptsFilesAndLinksToThem) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("file", "text");
  require_regular_file(file);
  std::filesystem::create_symlink(file, folder.path() / "link");
  require_regular_file(folder.path() / "link");
  require_regular_file(folder.path() / "missing");  // reported when it is opened
}

TEST(RegularFile, RejectsPipesDevicesAndFolders) {
  const TemporaryFolder folder;
  const std::string pipe = (folder.path() / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_input_error([&] { require_regular_file(pipe); }, {pipe, "is a pipe"});
  expect_input_error([] { require_regular_file("/dev/zero"); }, {"/dev/zero: is a device"});
  expect_input_error([&] { require_regular_file(folder.path()); }, {"is a folder; expected a file"});
}

}  // namespace
}  // namespace stillpoint
