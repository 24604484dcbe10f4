// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/shared_module.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint::datasets {
namespace {

TEST(SharedModule, IsSearchedBesideTheProgramBeforeTheSystem) {
  const std::vector<std::string> paths = module_paths("/build/dev/stillpoint", "imageio");
  ASSERT_EQ(paths.size(), 4u);
  EXPECT_EQ(paths[0], "/build/dev/lib/libstillpoint_imageio.so");  // of a program in a build folder
  EXPECT_EQ(module_paths("/usr/bin/stillpoint", "imageio")[2], "/usr/lib/libstillpoint_imageio.so");
  EXPECT_EQ(paths[3], "libstillpoint_imageio.so");
}

TEST(SharedModule, IsLoadedOnce) {
  const void* const symbol = module_symbol("imageio", "stillpoint_image_module");
  EXPECT_NE(symbol, nullptr);
  EXPECT_EQ(module_symbol("imageio", "stillpoint_image_module"), symbol);
}

TEST(SharedModule, RejectsAMissingModuleAndAMissingSymbolByTheFileName) {
  expect_input_error([] { static_cast<void>(module_symbol("absent", "symbol")); },
                     {"libstillpoint_absent.so"});
  expect_input_error([] { static_cast<void>(module_symbol("imageio", "absent")); },
                     {"libstillpoint_imageio.so"});
}

}  // namespace
}  // namespace stillpoint::datasets
