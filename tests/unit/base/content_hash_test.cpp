// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/content_hash.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

// Published values of XXH64 with seed 0: the empty text, one shorter than a word, one longer than a stripe.
TEST(ContentHash, MatchesThePublishedValues) {
  EXPECT_EQ(content_hash(""), 0xEF46DB3751D8E999u);
  EXPECT_EQ(content_hash("abc"), 0x44BC2CF5AD770999u);
  EXPECT_EQ(content_hash("Nobody inspects the spammish repetition"), 0xFBCEA83C8A378BF1u);
}

TEST(ContentHash, DependsOnTheSeed) { EXPECT_NE(content_hash("abc", 1), content_hash("abc", 2)); }

TEST(ContentHash, IsPrintedWithLeadingZeros) { EXPECT_EQ(hash_text(0xAB), "00000000000000ab"); }

}  // namespace
}  // namespace stillpoint
