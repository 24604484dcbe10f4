// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/error.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint {
namespace {

TEST(Utf8Text, AcceptsCharactersOfOneToFourBytes) {
  EXPECT_TRUE(is_utf8(""));
  EXPECT_TRUE(is_utf8("ascii"));
  EXPECT_TRUE(is_utf8("caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80"));
  EXPECT_TRUE(is_utf8("\xed\x9f\xbf \xee\x80\x80 \xf4\x8f\xbf\xbf"));  // neighbors of the excluded ranges
}

TEST(Utf8Text, RejectsWhatRfc3629Excludes) {
  for (const char* text : {"\xff", "\x80", "\xc3", "\xc3(", "\xe2\x82", "\xf0\x9f\x98",  // stray or truncated
                           "\xc0\xaf", "\xe0\x80\xaf", "\xf0\x80\x80\xaf",               // overlong
                           "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80"})
    EXPECT_FALSE(is_utf8(text)) << escaped_utf8(text);
}

TEST(Utf8Text, EscapesOnlyInvalidBytes) {
  EXPECT_EQ(escaped_utf8("caf\xc3\xa9\xff/\xc3"), "caf\xc3\xa9\\xff/\\xc3");
  expect_input_error([] { require_utf8("sequence name", "a\xff"); },
                     {"sequence name \"a\\xff\": is not valid"});
  require_utf8("sequence name", "a");
}

}  // namespace
}  // namespace stillpoint
