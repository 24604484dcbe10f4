// SPDX-License-Identifier: BSD-3-Clause
/// The headers of an HTTP response that a download uses.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace stillpoint::datasets {

/// `Content-Range: bytes first-last/total` (RFC 9110, section 14.4).
struct ContentRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  std::uint64_t total = 0;  ///< 0 = not stated ("*")
};

/// Empty if malformed or inconsistent.
[[nodiscard]] std::optional<ContentRange> parse_content_range(std::string_view text);

struct ResponseHeaders {
  std::string etag;  ///< empty if weak: a weak validator does not identify bytes
  std::string last_modified;
  std::optional<ContentRange> range;
  std::uint64_t content_length = 0;  ///< 0 = not stated
};

/// `headers` with one more line. A status line begins the headers of the next response, e.g. after a
/// redirect.
[[nodiscard]] ResponseHeaders with_header_line(ResponseHeaders headers, std::string_view line);

}  // namespace stillpoint::datasets
