// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/messages.h"

#include <algorithm>
#include <cmath>

#include "datasets/bags/byte_reader.h"

namespace stillpoint::datasets {
namespace {

constexpr std::size_t kEncapsulationBytes = 4;  ///< identifier (big endian) and options
constexpr std::size_t kMinTransformBytes = 68;  ///< of an empty header, empty names and 7 numbers

/// Reads the fields of one message in their order.
class FieldReader {
 public:
  explicit FieldReader(const SerializedMessage& message)
      : FieldReader(message,
                    message.format == WireFormat::kRos1 ? Body{message.bytes, {}} : body_of(message)) {}

  template <class Number>
  Number number() {
    return reader_.number<Number>();
  }

  [[nodiscard]] ByteReader& reader() { return reader_; }

  std::string text() { return std::string(reader_.text()); }

  /// Frames of early versions of tf begin with a slash.
  std::string frame() {
    std::string_view name = reader_.text();
    if (name.starts_with('/')) name.remove_prefix(1);
    return std::string(name);
  }

  MessageHeader header() {
    if (format_ == WireFormat::kRos1) number<std::uint32_t>();
    const std::int64_t seconds = format_ == WireFormat::kRos1 ? std::int64_t{number<std::uint32_t>()}
                                                              : std::int64_t{number<std::int32_t>()};
    const Timestamp stamp{seconds * 1'000'000'000 + number<std::uint32_t>()};
    return {.stamp = stamp, .frame = frame()};
  }

  template <std::size_t kSize>
  std::array<double, kSize> numbers() {
    std::array<double, kSize> values{};
    for (double& value : values) value = number<double>();
    return values;
  }

  Eigen::Vector3d vector() {
    const std::array<double, 3> values = numbers<3>();
    return {values[0], values[1], values[2]};
  }

  /// Position or translation, then the quaternion x y z w.
  std::optional<Pose> pose() {
    const Eigen::Vector3d p = vector();
    const std::array<double, 4> q = numbers<4>();
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!p.allFinite() || !std::isfinite(norm) || norm < 1e-3) return std::nullopt;
    Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
    // Normalizing again would change the last bits of a normalized quaternion.
    if (std::abs(norm - 1.0) > 1e-14) rotation.normalize();
    return Pose{rotation, p};
  }

 private:
  struct Body {
    std::string_view bytes;
    ByteLayout layout;
  };

  FieldReader(const SerializedMessage& message, const Body& body)
      : format_(message.format), reader_(body.bytes, message.place, body.layout) {}

  /// Plain CDR of version 1 or 2, which aligns numbers of 64 bits to 4 bytes.
  static Body body_of(const SerializedMessage& message) {
    ByteReader head(message.bytes, message.place);
    head.skip(1);
    const std::uint8_t identifier = head.number<std::uint8_t>();
    head.skip(2);
    const bool version1 = identifier == 0 || identifier == 1;
    if (message.bytes.front() != '\0' || !(version1 || identifier == 6 || identifier == 7))
      head.fail("has an encapsulation that is not plain CDR");
    return {message.bytes.substr(kEncapsulationBytes),
            {.max_alignment = version1 ? std::size_t{8} : std::size_t{4},
             .big_endian = identifier % 2 == 0,
             .terminated_texts = true}};
  }

  WireFormat format_;
  ByteReader reader_;
};

PoseMessage transform_of(FieldReader& fields) {
  PoseMessage result;
  result.header = fields.header();
  result.child = fields.frame();
  result.pose = fields.pose();
  return result;
}

ImageMessage image_head_of(FieldReader& fields) {
  ImageMessage image;
  image.header = fields.header();
  image.height = fields.number<std::uint32_t>();
  image.width = fields.number<std::uint32_t>();
  image.encoding = fields.text();
  image.big_endian = fields.number<std::uint8_t>() != 0;
  image.step = fields.number<std::uint32_t>();
  return image;
}

CompressedImageMessage compressed_head_of(FieldReader& fields) {
  CompressedImageMessage image;
  image.header = fields.header();
  image.format = fields.text();
  return image;
}

}  // namespace

MessageHeader parse_header(const SerializedMessage& message) { return FieldReader(message).header(); }

ImageMessage parse_image_head(const SerializedMessage& message) {
  FieldReader fields(message);
  return image_head_of(fields);
}

ImageMessage parse_image(const SerializedMessage& message) {
  FieldReader fields(message);
  ImageMessage image = image_head_of(fields);
  image.data = fields.reader().block();
  return image;
}

CompressedImageMessage parse_compressed_image_head(const SerializedMessage& message) {
  FieldReader fields(message);
  return compressed_head_of(fields);
}

CompressedImageMessage parse_compressed_image(const SerializedMessage& message) {
  FieldReader fields(message);
  CompressedImageMessage image = compressed_head_of(fields);
  image.data = fields.reader().block();
  return image;
}

CameraInfoMessage parse_camera_info(const SerializedMessage& message) {
  FieldReader fields(message);
  CameraInfoMessage info;
  info.header = fields.header();
  info.height = fields.number<std::uint32_t>();
  info.width = fields.number<std::uint32_t>();
  info.distortion_model = fields.text();
  info.D.resize(fields.reader().count(sizeof(double)));
  for (double& value : info.D) value = fields.number<double>();
  info.K = fields.numbers<9>();
  static_cast<void>(fields.numbers<9>());  // R: rectification of stereo cameras
  info.P = fields.numbers<12>();
  return info;
}

ImuMessage parse_imu(const SerializedMessage& message) {
  FieldReader fields(message);
  ImuMessage imu;
  imu.header = fields.header();
  static_cast<void>(fields.numbers<4 + 9>());  // orientation and its covariance
  imu.gyro = fields.vector();
  static_cast<void>(fields.numbers<9>());
  imu.accel = fields.vector();
  return imu;
}

NavSatFixMessage parse_nav_sat_fix(const SerializedMessage& message) {
  FieldReader fields(message);
  NavSatFixMessage fix;
  fix.header = fields.header();
  fix.status = fields.number<std::int8_t>();
  fields.number<std::uint16_t>();  // used satellite systems
  fix.latitude_deg = fields.number<double>();
  fix.longitude_deg = fields.number<double>();
  fix.altitude_m = fields.number<double>();
  return fix;
}

bool is_pose_type(std::string_view type) {
  constexpr std::array<std::string_view, 4> kTypes{"geometry_msgs/PoseStamped",
                                                   "geometry_msgs/PoseWithCovarianceStamped",
                                                   "geometry_msgs/TransformStamped", "nav_msgs/Odometry"};
  return std::ranges::find(kTypes, type) != kTypes.end();
}

PoseMessage parse_pose(const SerializedMessage& message, std::string_view type) {
  FieldReader fields(message);
  PoseMessage result;
  result.header = fields.header();
  if (type == "geometry_msgs/TransformStamped" || type == "nav_msgs/Odometry") result.child = fields.frame();
  result.pose = fields.pose();
  return result;
}

std::vector<PoseMessage> parse_transforms(const SerializedMessage& message) {
  FieldReader fields(message);
  std::vector<PoseMessage> transforms;
  const std::uint32_t count = fields.reader().count(kMinTransformBytes);
  for (std::uint32_t i = 0; i < count; ++i) transforms.push_back(transform_of(fields));
  return transforms;
}

std::optional<Pose> parse_transform(const SerializedMessage& message) { return FieldReader(message).pose(); }

float parse_float(const SerializedMessage& message) { return FieldReader(message).number<float>(); }

}  // namespace stillpoint::datasets
