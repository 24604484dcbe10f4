// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/http_transfer.h"

#include <gtest/gtest.h>

namespace stillpoint::datasets {
namespace {

TEST(ContentRange, IsParsedStrictly) {
  const auto range = parse_content_range("bytes 10-19/20");
  ASSERT_TRUE(range);
  EXPECT_EQ(range->first, 10U);
  EXPECT_EQ(range->last, 19U);
  EXPECT_EQ(range->total, 20U);
  EXPECT_EQ(parse_content_range("bytes 0-9/*")->total, 0U);
  for (const char* text : {"", "bytes", "bytes 5-4/10", "bytes 0-10/10", "items 0-1/2", "bytes a-1/2",
                           "bytes 0-1", "bytes */10", "bytes 0-18446744073709551616/*"})
    EXPECT_FALSE(parse_content_range(text)) << text;
}

TEST(ResponseHeaders, AreThoseOfTheLastResponse) {
  ResponseHeaders headers;
  for (const char* line : {"HTTP/1.1 302 Found\r\n", "ETag: \"redirect\"\r\n", "HTTP/1.1 200 OK\r\n",
                           "content-length: 12\r\n", "Last-Modified: yesterday\r\n"})
    headers = with_header_line(std::move(headers), line);
  EXPECT_EQ(headers.etag, "");
  EXPECT_EQ(headers.last_modified, "yesterday");
  EXPECT_EQ(headers.content_length, 12U);
}

TEST(ResponseHeaders, HaveNoWeakETag) {
  EXPECT_EQ(with_header_line({}, "ETag: W/\"a\"\r\n").etag, "");
  EXPECT_EQ(with_header_line({}, "ETag: \"a\"\r\n").etag, "\"a\"");
}

TEST(ContentState, IsTheSameOnlyWithACommonStatement) {
  const ContentState a{.url = "u", .etag = "\"a\"", .last_modified = "", .total = 10};
  EXPECT_TRUE(is_same_content(a, a));
  EXPECT_TRUE(is_same_content(a, {.url = "u", .etag = "", .last_modified = "", .total = 10}));
  EXPECT_FALSE(is_same_content(a, {.url = "u", .etag = "\"a\"", .last_modified = "", .total = 11}));
  EXPECT_FALSE(is_same_content(a, {.url = "u", .etag = "\"b\"", .last_modified = "", .total = 10}));
  EXPECT_FALSE(is_same_content({}, {}));
}

}  // namespace
}  // namespace stillpoint::datasets
