// SPDX-License-Identifier: BSD-3-Clause
/// Bytes of binary files: a reader of numbers and texts whose every access is checked, its inverse, and a
/// file that gets its name when it is complete.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/timestamp.h"

namespace stillpoint::datasets {

/// How numbers are stored. The defaults are those of all containers and of ROS 1 messages.
struct ByteLayout {
  std::size_t max_alignment = 1;  ///< a number begins at a multiple of its size, at most of this
  bool big_endian = false;
  bool terminated_texts = false;  ///< whether the length of a text includes a final 0
};

/// Reads numbers and texts in their order.
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

inline constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Appends numbers and texts, little endian.
class ByteWriter {
 public:
  /// @param max_alignment see `ByteLayout`
  explicit ByteWriter(std::size_t max_alignment = 1, bool terminated_texts = false)
      : max_alignment_(max_alignment), terminated_texts_(terminated_texts) {}

  template <class Number>
  ByteWriter& number(Number value) {
    static_assert(std::endian::native == std::endian::little);
    const std::size_t step = sizeof(Number) < max_alignment_ ? sizeof(Number) : max_alignment_;
    bytes_.append((step - bytes_.size() % step) % step, '\0');
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(Number));
    return *this;
  }

  ByteWriter& append(std::string_view bytes) {
    bytes_.append(bytes);
    return *this;
  }

  /// A length of 32 bits, and the bytes.
  ByteWriter& block(std::string_view bytes) {
    STILLPOINT_CHECK(bytes.size() <= UINT32_MAX);
    return number(static_cast<std::uint32_t>(bytes.size())).append(bytes);
  }

  ByteWriter& text(std::string_view value) {
    return terminated_texts_ ? block(std::string(value) + '\0') : block(value);
  }

  /// Seconds and nanoseconds of 32 bits each, as in records and messages of ROS.
  ByteWriter& time(Timestamp t) {
    return number(static_cast<std::uint32_t>(t.ns / kSecond_ns))
        .number(static_cast<std::uint32_t>(t.ns % kSecond_ns));
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  [[nodiscard]] std::string take() { return std::exchange(bytes_, {}); }

 private:
  std::size_t max_alignment_;
  bool terminated_texts_;
  std::string bytes_;
};

/// A binary file: writes to NAME.part, which is removed unless `finish` is called.
class OutputFile {
 public:
  /// @throws InputError if it cannot be created
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  [[nodiscard]] std::uint64_t position() const { return position_; }
  void append(std::string_view bytes);

  /// Replaces bytes that were written before.
  void overwrite(std::uint64_t position, std::string_view bytes);

  /// Gives all bytes to the system, so that they survive the end of this process.
  void flush() { out_.flush(); }

  /// Renames the file.
  /// @throws InputError if it could not be written completely
  void finish();

 private:
  [[nodiscard]] std::filesystem::path unfinished() const { return path_.string() + ".part"; }

  std::filesystem::path path_;
  std::ofstream out_;
  std::uint64_t position_ = 0;
  bool finished_ = false;
};

}  // namespace stillpoint::datasets
