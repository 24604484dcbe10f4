// SPDX-License-Identifier: BSD-3-Clause
/// Reads numbers and texts from bytes of a bag; every access is checked.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace stillpoint::datasets {

/// How numbers are stored. The defaults are those of all containers and of ROS 1 messages.
struct ByteLayout {
  std::size_t max_alignment = 1;  ///< a number begins at a multiple of its size, at most of this
  bool big_endian = false;
  bool terminated_texts = false;  ///< whether the length of a text includes a final 0
};

class ByteReader {
 public:
  /// @param bytes, place must outlive this object; `place` is named in errors
  ByteReader(std::string_view bytes, std::string_view place, ByteLayout layout = {})
      : bytes_(bytes), place_(place), layout_(layout) {}

  [[nodiscard]] std::size_t position() const { return position_; }
  [[nodiscard]] std::size_t remaining() const { return bytes_.size() - position_; }

  /// The next number.
  /// @throws InputError, as all functions, if the bytes end before
  template <class Number>
  Number number() {
    align(sizeof(Number));
    std::array<char, sizeof(Number)> raw{};
    std::memcpy(raw.data(), take(sizeof(Number)).data(), sizeof(Number));
    if (layout_.big_endian != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Number>(raw);
  }

  /// The next `count` bytes.
  std::string_view take(std::uint64_t count) {
    if (count > remaining()) fail("ends too early");
    const std::string_view part = bytes_.substr(position_, count);
    position_ += count;
    return part;
  }

  /// A length of 32 bits, and as many bytes.
  std::string_view block() { return take(number<std::uint32_t>()); }

  /// A text with its length.
  std::string_view text() {
    std::string_view part = block();
    if (layout_.terminated_texts && !part.empty() && part.back() == '\0') part.remove_suffix(1);
    return part;
  }

  /// The length of an array whose items have at least `item_bytes` bytes each.
  std::uint32_t count(std::size_t item_bytes) {
    const std::uint32_t items = number<std::uint32_t>();
    if (items > remaining() / item_bytes) fail("contains an array that is longer than its bytes");
    return items;
  }

  void skip(std::uint64_t count) { take(count); }

  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(std::string(place_), problem + "; it is damaged, copy the file again");
  }

 private:
  void align(std::size_t size) {
    const std::size_t step = std::min(size, layout_.max_alignment);
    skip((step - position_ % step) % step);
  }

  std::string_view bytes_;
  std::string_view place_;
  ByteLayout layout_;
  std::size_t position_ = 0;
};

}  // namespace stillpoint::datasets
