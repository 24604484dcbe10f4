// SPDX-License-Identifier: BSD-3-Clause
/// Appends numbers and texts to bytes of a bag: the inverse of `ByteReader`, little endian.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/timestamp.h"

namespace stillpoint::datasets {

inline constexpr std::int64_t kSecond_ns = 1'000'000'000;

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

}  // namespace stillpoint::datasets
