// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/error.h"

#include <cstddef>
#include <string>

namespace stillpoint {

void check_failed(const char* condition, const char* file, int line) {
  throw std::logic_error(std::string(file) + ":" + std::to_string(line) + ": internal error: " + condition +
                         " does not hold; please report it");
}

void require_regular_file(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  const auto reject = [&](const std::string& kind) {
    throw InputError(file.string(), "is a " + kind + "; expected a file");
  };
  std::error_code error;
  switch (fs::status(file, error).type()) {
    case fs::file_type::directory:
      return reject("folder");
    case fs::file_type::fifo:
      return reject("pipe");
    case fs::file_type::socket:
      return reject("socket");
    case fs::file_type::block:
    case fs::file_type::character:
      return reject("device");
    default:
      return;
  }
}

namespace {

/// Bytes of one character by its first byte, and the range of its second byte, which excludes overlong forms,
/// surrogates and characters above U+10FFFF (RFC 3629, section 4).
struct Sequence {
  std::size_t bytes = 0;  ///< 0: not the first byte of a character
  unsigned char low = 0x80;
  unsigned char high = 0xbf;
};

Sequence sequence_of(unsigned char first) {
  if (first < 0x80) return {.bytes = 1};
  if (first < 0xc2) return {};
  if (first < 0xe0) return {.bytes = 2};
  if (first == 0xe0) return {.bytes = 3, .low = 0xa0};
  if (first == 0xed) return {.bytes = 3, .high = 0x9f};
  if (first < 0xf0) return {.bytes = 3};
  if (first == 0xf0) return {.bytes = 4, .low = 0x90};
  if (first < 0xf4) return {.bytes = 4};
  if (first == 0xf4) return {.bytes = 4, .high = 0x8f};
  return {};
}

/// Length of the valid character at the beginning of `text`; 0 if there is none.
std::size_t character_bytes(std::string_view text) {
  const Sequence sequence = sequence_of(static_cast<unsigned char>(text.front()));
  if (sequence.bytes > text.size()) return 0;
  for (std::size_t i = 1; i < sequence.bytes; ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool valid = i == 1 ? byte >= sequence.low && byte <= sequence.high : byte >= 0x80 && byte <= 0xbf;
    if (!valid) return 0;
  }
  return sequence.bytes;
}

}  // namespace

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t bytes = character_bytes(text);
    if (bytes == 0) return false;
    text.remove_prefix(bytes);
  }
  return true;
}

std::string escaped_utf8(std::string_view text) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string escaped;
  while (!text.empty()) {
    const std::size_t bytes = character_bytes(text);
    if (bytes == 0) {
      const auto byte = static_cast<unsigned char>(text.front());
      escaped += {'\\', 'x', kDigits[byte / 16], kDigits[byte % 16]};
    } else {
      escaped += text.substr(0, bytes);
    }
    text.remove_prefix(bytes == 0 ? 1 : bytes);
  }
  return escaped;
}

void require_utf8(const std::string& what, std::string_view name) {
  if (is_utf8(name)) return;
  throw InputError(what + " \"" + escaped_utf8(name) + "\"", "is not valid UTF-8; rename it");
}

}  // namespace stillpoint
