// SPDX-License-Identifier: BSD-3-Clause
/// Bytes as text, for files in JSON, HTML and SVG (RFC 4648, Section 4, with padding).
#pragma once

#include <string>
#include <string_view>

namespace stillpoint::eval {

[[nodiscard]] std::string base64(std::string_view bytes);

/// The bytes of a text that `base64` made.
/// @throws InputError if it is no such text
[[nodiscard]] std::string bytes_of_base64(std::string_view text);

}  // namespace stillpoint::eval
