// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/base64.h"

#include <algorithm>
#include <cstdint>

#include "core/base/error.h"

namespace stillpoint::eval {
namespace {

constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

std::string base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kAlphabet[group >> (18 - 6 * k) & 0x3F] : '=';
  }
  return text;
}

std::string bytes_of_base64(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i + 4 <= text.size(); i += 4) {
    std::uint32_t group = 0;
    for (const char c : text.substr(i, 4))
      group = group << 6 | static_cast<std::uint32_t>(c == '=' ? 0 : kAlphabet.find(c) & 0x3F);
    for (const int shift : {16, 8, 0}) bytes += static_cast<char>(group >> shift & 0xFF);
  }
  bytes.resize(bytes.size() - std::min<std::size_t>(bytes.size(), std::ranges::count(text, '=')));
  if (base64(bytes) != text) throw InputError("base64 text", "has other characters or another length");
  return bytes;
}

}  // namespace stillpoint::eval
