// SPDX-License-Identifier: BSD-3-Clause
/// The wire format of Protocol Buffers, as far as messages of Foxglove need it: a writer of fields, and a
/// reader that returns them one by one. Specification: protobuf.dev/programming-guides/encoding.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "datasets/io/byte_stream.h"

namespace stillpoint::datasets {

/// Wire types of fields.
enum class ProtobufWire : std::uint8_t { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };

/// Appends fields of one message.
class ProtobufWriter {
 public:
  /// A field of type int32, int64, uint32, bool or enum. Negative numbers are sign-extended to 64 bits.
  ProtobufWriter& integer(int field, std::int64_t value) {
    tag(field, ProtobufWire::kVarint);
    return varint(static_cast<std::uint64_t>(value));
  }

  ProtobufWriter& number(int field, double value) {
    tag(field, ProtobufWire::kFixed64);
    bytes_.number(value);
    return *this;
  }

  ProtobufWriter& fixed32(int field, std::uint32_t value) {
    tag(field, ProtobufWire::kFixed32);
    bytes_.number(value);
    return *this;
  }

  /// A field of type string, bytes, or an encoded message.
  ProtobufWriter& bytes(int field, std::string_view value) {
    tag(field, ProtobufWire::kBytes);
    varint(value.size());
    bytes_.append(value);
    return *this;
  }

  /// A repeated field of doubles, packed.
  ProtobufWriter& numbers(int field, std::span<const double> values) {
    tag(field, ProtobufWire::kBytes);
    varint(values.size_bytes());
    for (const double value : values) bytes_.number(value);
    return *this;
  }

  [[nodiscard]] std::string take() { return bytes_.take(); }

 private:
  void tag(int field, ProtobufWire wire) {
    varint(static_cast<std::uint64_t>(field) << 3 | static_cast<std::uint64_t>(wire));
  }

  ProtobufWriter& varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_.number(static_cast<std::uint8_t>(value | 0x80));
    bytes_.number(static_cast<std::uint8_t>(value));
    return *this;
  }

  ByteWriter bytes_;
};

/// One field of a message.
struct ProtobufField {
  int number = 0;
  std::uint64_t value = 0;  ///< of the numeric wire types, as stored
  std::string_view bytes;   ///< of `kBytes`

  [[nodiscard]] double as_double() const { return std::bit_cast<double>(value); }
};

/// Reads the fields of one message in their order.
class ProtobufReader {
 public:
  /// @param bytes, place must outlive this object; `place` is named in errors
  ProtobufReader(std::string_view bytes, std::string_view place) : reader_(bytes, place) {}

  /// @return nullopt at the end
  /// @throws InputError if the message is damaged
  [[nodiscard]] std::optional<ProtobufField> next() {
    if (reader_.remaining() == 0) return std::nullopt;
    const std::uint64_t tag = varint();
    ProtobufField field{.number = static_cast<int>(tag >> 3 & 0x1fffffff), .value = 0, .bytes = {}};
    switch (static_cast<ProtobufWire>(tag & 7)) {
      case ProtobufWire::kVarint:
        field.value = varint();
        break;
      case ProtobufWire::kFixed64:
        field.value = reader_.number<std::uint64_t>();
        break;
      case ProtobufWire::kBytes:
        field.bytes = reader_.take(varint());
        break;
      case ProtobufWire::kFixed32:
        field.value = reader_.number<std::uint32_t>();
        break;
      default:
        reader_.fail("has a field of an unknown wire type");
    }
    return field;
  }

 private:
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const auto byte = reader_.number<std::uint8_t>();
      value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
    reader_.fail("has an integer of more than 64 bits");
  }

  ByteReader reader_;
};

}  // namespace stillpoint::datasets
