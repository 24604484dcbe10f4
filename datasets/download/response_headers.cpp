// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/response_headers.h"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace stillpoint::datasets {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

std::optional<std::uint64_t> number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<ContentRange> parse_content_range(std::string_view text) {
  constexpr std::string_view kUnit = "bytes ";
  text = trimmed(text);
  if (!text.starts_with(kUnit)) return std::nullopt;
  text = trimmed(text.substr(kUnit.size()));
  const std::size_t dash = text.find('-');
  const std::size_t slash = text.find('/');
  if (dash == std::string_view::npos || slash == std::string_view::npos || slash < dash) return std::nullopt;
  const auto first = number(text.substr(0, dash));
  const auto last = number(text.substr(dash + 1, slash - dash - 1));
  const std::string_view size = text.substr(slash + 1);
  const auto total = size == "*" ? std::optional<std::uint64_t>(0) : number(size);
  if (!first || !last || !total || *last < *first || (size != "*" && *last >= *total)) return std::nullopt;
  return ContentRange{*first, *last, *total};
}

ResponseHeaders with_header_line(ResponseHeaders headers, std::string_view line) {
  if (line.starts_with("HTTP/")) return {};
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return headers;
  std::string name(line.substr(0, colon));
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  const std::string_view value = trimmed(line.substr(colon + 1));
  if (name == "etag" && !value.starts_with("W/")) headers.etag = value;
  if (name == "last-modified") headers.last_modified = value;
  if (name == "content-range") headers.range = parse_content_range(value);
  if (name == "content-length") headers.content_length = number(value).value_or(0);
  return headers;
}

}  // namespace stillpoint::datasets
