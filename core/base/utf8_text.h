// SPDX-License-Identifier: BSD-3-Clause
/// Validation of UTF-8: JSON, HTML and the terminal cannot represent other bytes.
#pragma once

#include <string>
#include <string_view>

namespace stillpoint {

/// Whether `text` is valid UTF-8 (RFC 3629: no overlong forms, no surrogates, at most U+10FFFF).
[[nodiscard]] bool is_utf8(std::string_view text);

/// `text` with each byte that is not part of valid UTF-8 written as `\xNN`.
[[nodiscard]] std::string escaped_utf8(std::string_view text);

/// @param what kind of name, e.g. "sequence name"
/// @param name the name to check
/// @throws InputError if `name` is not valid UTF-8; the message contains it escaped
void require_utf8(const std::string& what, std::string_view name);

}  // namespace stillpoint
