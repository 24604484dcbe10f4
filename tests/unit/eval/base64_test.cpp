// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/base64.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint::eval {
namespace {

TEST(Base64, ConformsToRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(Base64, GivesBackEveryByte) {
  std::string bytes;
  for (int byte = 0; byte < 256; ++byte) {
    bytes += static_cast<char>(byte);
    EXPECT_EQ(bytes_of_base64(base64(bytes)), bytes);
  }
  for (const char* text : {"Zg=", "Zg", "Zm8?", "Zh==", "====", "Z==="})
    expect_input_error([&] { static_cast<void>(bytes_of_base64(text)); }, {"base64 text"});
}

}  // namespace
}  // namespace stillpoint::eval
