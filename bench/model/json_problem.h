// SPDX-License-Identifier: BSD-3-Clause
/// Messages of the JSON library without its error identifiers.
#pragma once

#include <exception>
#include <string>

namespace stillpoint::bench {

/// The problem that a `nlohmann::json::exception` describes, e.g. "parse error at line 1, column 4: ..." for
/// "[json.exception.parse_error.101] parse error at line 1, column 4: ...".
[[nodiscard]] inline std::string json_problem(const std::exception& error) {
  const std::string text = error.what();
  const std::size_t end = text.find("] ");
  return text.starts_with("[json.") && end != std::string::npos ? text.substr(end + 2) : text;
}

}  // namespace stillpoint::bench
