// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/foxglove/messages.h"

#include <array>
#include <cstring>

#include "datasets/foxglove/protobuf.h"

namespace stillpoint::datasets {
namespace {

/// Values of foxglove.PointsAnnotation.Type and foxglove.PackedElementField.NumericType.
constexpr std::int64_t kPointsType = 1;
constexpr std::int64_t kLineLoopType = 2;
constexpr std::int64_t kUint8Type = 1;
constexpr std::int64_t kFloat32Type = 7;

constexpr double kPointThickness_px = 6.0;
constexpr double kLineThickness_px = 2.0;
constexpr double kFontSize_px = 14.0;

std::string encode_quaternion(const Eigen::Quaterniond& q) {
  return ProtobufWriter().number(1, q.x()).number(2, q.y()).number(3, q.z()).number(4, q.w()).take();
}

std::string encode_point(const Eigen::Vector2d& pixel) {
  return ProtobufWriter().number(1, pixel.x() + 0.5).number(2, pixel.y() + 0.5).take();
}

std::string encode_color(const MessageColor& color, double alpha = 1.0) {
  return ProtobufWriter()
      .number(1, color.r / 255.0)
      .number(2, color.g / 255.0)
      .number(3, color.b / 255.0)
      .number(4, alpha)
      .take();
}

}  // namespace

std::string encode_timestamp(Timestamp t) {
  return ProtobufWriter().integer(1, t.ns / kSecond_ns).integer(2, t.ns % kSecond_ns).take();
}

std::string encode_vector(const Eigen::Vector3d& vector) {
  return ProtobufWriter().number(1, vector.x()).number(2, vector.y()).number(3, vector.z()).take();
}

std::string encode_pose(const Pose& pose) {
  return ProtobufWriter().bytes(1, encode_vector(pose.p)).bytes(2, encode_quaternion(pose.q)).take();
}

std::string encode_pose_in_frame(const FoxgloveHeader& header, const Pose& pose) {
  return ProtobufWriter()
      .bytes(1, encode_timestamp(header.t))
      .bytes(2, header.frame)
      .bytes(3, encode_pose(pose))
      .take();
}

std::string encode_path(const FoxgloveHeader& header, std::span<const Pose> poses) {
  ProtobufWriter writer;
  writer.bytes(1, encode_timestamp(header.t)).bytes(2, header.frame);
  for (const Pose& pose : poses) writer.bytes(3, encode_pose(pose));
  return writer.take();
}

std::string encode_transform(const FoxgloveHeader& header, std::string_view child, const Pose& pose) {
  return ProtobufWriter()
      .bytes(1, encode_timestamp(header.t))
      .bytes(2, header.frame)
      .bytes(3, child)
      .bytes(4, encode_vector(pose.p))
      .bytes(5, encode_quaternion(pose.q))
      .take();
}

std::string encode_camera(const FoxgloveHeader& header, const Camera& camera) {
  const bool is_fisheye = camera.model == CameraModel::kKannalaBrandt;
  const char* const model = is_fisheye                 ? "kannala_brandt"
                            : camera.has_denominator() ? "rational_polynomial"
                                                       : "plumb_bob";
  const auto distortion =
      is_fisheye ? std::span<const double>(camera.distortion).first(4) : camera.coefficients();
  const std::array<double, 9> K = {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
  const std::array<double, 9> R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  const std::array<double, 12> P = {camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy,
                                    camera.cy, 0.0, 0.0,       0.0, 1.0, 0.0};
  return ProtobufWriter()
      .bytes(1, encode_timestamp(header.t))
      .fixed32(2, static_cast<std::uint32_t>(camera.width))
      .fixed32(3, static_cast<std::uint32_t>(camera.height))
      .bytes(4, model)
      .numbers(5, distortion)
      .numbers(6, K)
      .numbers(7, R)
      .numbers(8, P)
      .bytes(9, header.frame)
      .take();
}

std::string encode_jpeg_message(const FoxgloveHeader& header, std::string_view jpeg) {
  return ProtobufWriter()
      .bytes(1, encode_timestamp(header.t))
      .bytes(2, jpeg)
      .bytes(3, "jpeg")
      .bytes(4, header.frame)
      .take();
}

namespace {

/// Rows without padding.
struct RawRows {
  std::string_view encoding;
  int columns;
  std::size_t pixel_bytes;
  std::string_view bytes;
};

std::string encode_raw_image(const FoxgloveHeader& header, const RawRows& rows) {
  const std::size_t row_bytes = static_cast<std::size_t>(rows.columns) * rows.pixel_bytes;
  return ProtobufWriter()
      .bytes(1, encode_timestamp(header.t))
      .fixed32(2, static_cast<std::uint32_t>(rows.columns))
      .fixed32(3, static_cast<std::uint32_t>(rows.bytes.size() / row_bytes))
      .bytes(4, rows.encoding)
      .fixed32(5, static_cast<std::uint32_t>(row_bytes))
      .bytes(6, rows.bytes)
      .bytes(7, header.frame)
      .take();
}

}  // namespace

std::string encode_deep_image(const FoxgloveHeader& header, int width,
                              std::span<const std::uint16_t> pixels) {
  const std::string_view bytes{reinterpret_cast<const char*>(pixels.data()), pixels.size_bytes()};
  return encode_raw_image(header, {"16UC1", width, sizeof(std::uint16_t), bytes});
}

std::string encode_mono_image(const FoxgloveHeader& header, int width, std::span<const std::uint8_t> pixels) {
  const std::string_view bytes{reinterpret_cast<const char*>(pixels.data()), pixels.size()};
  return encode_raw_image(header, {"mono8", width, 1, bytes});
}

std::string encode_annotations(Timestamp t, std::span<const AnnotatedPoints> annotations) {
  const std::string stamp = encode_timestamp(t);
  ProtobufWriter message;
  for (const AnnotatedPoints& points : annotations) {
    const std::string color = encode_color(points.color);
    ProtobufWriter writer;
    writer.bytes(1, stamp).integer(2, points.closed_line ? kLineLoopType : kPointsType);
    for (const Eigen::Vector2d& pixel : points.pixels) writer.bytes(3, encode_point(pixel));
    writer.bytes(4, color).bytes(6, points.closed_line ? encode_color({}, 0.0) : color);
    writer.number(7, points.closed_line ? kLineThickness_px : kPointThickness_px);
    message.bytes(2, writer.take());
  }
  for (const AnnotatedPoints& points : annotations) {
    if (points.text.empty()) continue;
    message.bytes(3, ProtobufWriter()
                         .bytes(1, stamp)
                         .bytes(2, encode_point(points.pixels.front()))
                         .bytes(3, points.text)
                         .number(4, kFontSize_px)
                         .bytes(5, encode_color(points.color))
                         .bytes(6, encode_color({}, 0.0))
                         .take());
  }
  return message.take();
}

std::string encode_point_cloud(const FoxgloveHeader& header, std::span<const ColoredPoint> points) {
  constexpr std::uint32_t kStride = 3 * sizeof(float) + 4;
  ProtobufWriter writer;
  writer.bytes(1, encode_timestamp(header.t)).bytes(2, header.frame).bytes(3, encode_pose({}));
  writer.fixed32(4, kStride);
  std::uint32_t offset = 0;
  for (const char* const name : {"x", "y", "z", "red", "green", "blue", "alpha"}) {
    const bool is_coordinate = offset < 3 * sizeof(float);
    writer.bytes(5, ProtobufWriter()
                        .bytes(1, name)
                        .fixed32(2, offset)
                        .integer(3, is_coordinate ? kFloat32Type : kUint8Type)
                        .take());
    offset += is_coordinate ? std::uint32_t{sizeof(float)} : 1;
  }
  ByteWriter data;
  for (const ColoredPoint& point : points) {
    data.number(point.p.x()).number(point.p.y()).number(point.p.z());
    data.number(point.color.r).number(point.color.g).number(point.color.b).number(std::uint8_t{255});
  }
  return writer.bytes(6, data.bytes()).take();
}

namespace {

/// The doubles in the fields 1 to `N` of a message; 0 for those that are absent.
template <std::size_t N>
std::array<double, N> decode_doubles(std::string_view bytes, std::string_view place) {
  std::array<double, N> values{};
  ProtobufReader reader(bytes, place);
  while (const auto field = reader.next()) {
    if (field->number >= 1 && field->number <= static_cast<int>(N))
      values[static_cast<std::size_t>(field->number - 1)] = field->as_double();
  }
  return values;
}

Timestamp decode_timestamp(std::string_view bytes, std::string_view place) {
  constexpr std::uint64_t kMaxSeconds = 9'000'000'000;
  std::uint64_t seconds = 0;
  std::uint64_t nanoseconds = 0;
  ProtobufReader reader(bytes, place);
  while (const auto field = reader.next()) {
    if (field->number == 1) seconds = field->value;
    if (field->number == 2) nanoseconds = field->value;
  }
  if (seconds > kMaxSeconds || nanoseconds >= static_cast<std::uint64_t>(kSecond_ns))
    throw InputError(std::string(place), "has a time out of range; the file is damaged");
  return Timestamp{static_cast<std::int64_t>(seconds) * kSecond_ns + static_cast<std::int64_t>(nanoseconds)};
}

}  // namespace

PoseInFrameMessage decode_pose_in_frame(std::string_view bytes, std::string_view place) {
  PoseInFrameMessage message;
  ProtobufReader reader(bytes, place);
  while (const auto field = reader.next()) {
    if (field->number == 1) message.t = decode_timestamp(field->bytes, place);
    if (field->number == 2) message.frame = field->bytes;
    if (field->number != 3) continue;
    ProtobufReader pose(field->bytes, place);
    while (const auto part = pose.next()) {
      if (part->number == 1) message.position = Eigen::Vector3d(decode_doubles<3>(part->bytes, place).data());
      if (part->number != 2) continue;
      const std::array<double, 4> q = decode_doubles<4>(part->bytes, place);
      message.orientation = Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
    }
  }
  return message;
}

}  // namespace stillpoint::datasets
