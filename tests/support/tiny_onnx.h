// SPDX-License-Identifier: BSD-3-Clause
/// An ONNX network with constant output, for tests of the output decoding.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace stillpoint {

/// Writer of a protocol buffer message in the wire format.
class ProtoMessage {
 public:
  ProtoMessage& number(int field, std::uint64_t value) {
    varint(static_cast<std::uint64_t>(field) << 3);
    varint(value);
    return *this;
  }
  ProtoMessage& bytes(int field, const std::string& value) {
    varint((static_cast<std::uint64_t>(field) << 3) | 2);
    varint(value.size());
    text_ += value;
    return *this;
  }
  ProtoMessage& message(int field, const ProtoMessage& value) { return bytes(field, value.text_); }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void varint(std::uint64_t value) {
    for (; value >= 128; value >>= 7) text_ += static_cast<char>((value & 127) | 128);
    text_ += static_cast<char>(value);
  }
  std::string text_;
};

template <typename T>
constexpr std::uint64_t kOnnxType = std::is_same_v<T, float> ? 1 : 7;

/// A tensor of float or int64 numbers.
template <typename T>
ProtoMessage onnx_tensor(const std::string& name, const std::vector<std::int64_t>& dims,
                         const std::vector<T>& numbers) {
  ProtoMessage result;
  for (const std::int64_t dim : dims) result.number(1, static_cast<std::uint64_t>(dim));
  std::string raw(numbers.size() * sizeof(T), '\0');
  std::memcpy(raw.data(), numbers.data(), raw.size());
  result.number(2, kOnnxType<T>).bytes(8, name).bytes(9, raw);
  return result;
}

inline ProtoMessage onnx_node(const std::string& type, const std::vector<std::string>& inputs,
                              const std::string& output) {
  ProtoMessage result;
  for (const std::string& input : inputs) result.bytes(1, input);
  return result.bytes(2, output).bytes(3, output + "_node").bytes(4, type);
}

/// Name and shape of an input or output of floats.
inline ProtoMessage onnx_value(const std::string& name, const std::vector<std::int64_t>& dims) {
  ProtoMessage shape_message, tensor_type, type, result;
  for (const std::int64_t dim : dims)
    shape_message.message(1, ProtoMessage().number(1, static_cast<std::uint64_t>(dim)));
  tensor_type.number(1, 1).message(2, shape_message);
  type.message(1, tensor_type);
  return result.bytes(1, name).message(2, type);
}

/// Content of a .onnx file whose output has the values `numbers` in the shape `shape`: global average
/// pooling, zero weights, bias `numbers`. Field numbers are those of onnx.proto.
inline std::string constant_onnx(const std::vector<float>& numbers, const std::vector<std::int64_t>& shape,
                                 int input_px) {
  const auto count = static_cast<std::int64_t>(numbers.size());
  const std::vector<float> zeros(3 * numbers.size(), 0.0F);
  const ProtoMessage kernel = ProtoMessage().bytes(1, "kernel_shape").number(8, 1).number(8, 1).number(20, 7);
  ProtoMessage graph;
  graph.message(1, onnx_node("GlobalAveragePool", {"images"}, "mean"))
      .message(1, onnx_node("Conv", {"mean", "weights", "numbers"}, "row").message(5, kernel))
      .message(1, onnx_node("Reshape", {"row", "shape"}, "output"))
      .bytes(2, "constant")
      .message(5, onnx_tensor("weights", {count, 3, 1, 1}, zeros))
      .message(5, onnx_tensor("numbers", {count}, numbers))
      .message(5, onnx_tensor("shape", {static_cast<std::int64_t>(shape.size())}, shape))
      .message(11, onnx_value("images", {1, 3, input_px, input_px}))
      .message(12, onnx_value("output", shape));
  ProtoMessage model;
  model.number(1, 7).message(7, graph).message(8, ProtoMessage().bytes(1, "").number(2, 11));
  return model.text();
}

}  // namespace stillpoint
