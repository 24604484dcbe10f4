// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/messages.h"

#include <algorithm>
#include <cmath>

#include "datasets/foxglove/messages.h"
#include "datasets/io/byte_stream.h"

namespace stillpoint::datasets {
namespace {

constexpr std::size_t kEncapsulationBytes = 4;  ///< identifier (big endian) and options
constexpr std::size_t kMinTransformBytes = 68;  ///< of an empty header, empty names and 7 numbers

/// @return nullopt if the rotation has no direction, or a number is not finite
std::optional<Pose> valid_pose(const Eigen::Vector3d& p, Eigen::Quaterniond rotation) {
  const double norm = rotation.coeffs().norm();
  if (!p.allFinite() || !std::isfinite(norm) || norm < 1e-3) return std::nullopt;
  // Normalizing again would change the last bits of a normalized quaternion.
  if (std::abs(norm - 1.0) > 1e-14) rotation.normalize();
  return Pose{rotation, p};
}

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
    return valid_pose(p, Eigen::Quaterniond(q[3], q[0], q[1], q[2]));
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
  info.binning_x = fields.number<std::uint32_t>();
  info.binning_y = fields.number<std::uint32_t>();
  info.region = {.x = fields.number<std::uint32_t>(),
                 .y = fields.number<std::uint32_t>(),
                 .height = fields.number<std::uint32_t>(),
                 .width = fields.number<std::uint32_t>()};
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
  constexpr std::array<std::string_view, 5> kTypes{
      "geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped",
      "geometry_msgs/TransformStamped", "nav_msgs/Odometry", kPoseInFrameType};
  return std::ranges::find(kTypes, type) != kTypes.end();
}

PoseMessage parse_pose(const SerializedMessage& message, std::string_view type) {
  if (type == kPoseInFrameType) {
    const PoseInFrameMessage pose = decode_pose_in_frame(message.bytes, message.place);
    return {.header = {.stamp = pose.t, .frame = pose.frame},
            .child = {},
            .pose = valid_pose(pose.position, pose.orientation)};
  }
  FieldReader fields(message);
  PoseMessage result;
  result.header = fields.header();
  if (type == "geometry_msgs/TransformStamped" || type == "nav_msgs/Odometry") result.child = fields.frame();
  result.pose = fields.pose();
  if (type == "geometry_msgs/PoseWithCovarianceStamped" || type == "nav_msgs/Odometry")
    result.covariance = fields.numbers<36>();
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

namespace {

constexpr std::string_view kCdrLittleEndian{"\0\1\0\0", 4};
constexpr int kPoseCovariance = 36;  ///< 6x6

/// Writes the fields of one message in their order.
class FieldWriter {
 public:
  explicit FieldWriter(WireFormat format)
      : format_(format), writer_(format == WireFormat::kRos1 ? ByteWriter() : ByteWriter(8, true)) {}

  [[nodiscard]] ByteWriter& writer() { return writer_; }

  FieldWriter& header(const MessageHeader& header) {
    if (format_ == WireFormat::kRos1) writer_.number(std::uint32_t{0});
    writer_.time(header.stamp).text(header.frame);
    return *this;
  }

  template <class Numbers>
  FieldWriter& numbers(const Numbers& values) {
    for (const double value : values) writer_.number(value);
    return *this;
  }

  FieldWriter& zeros(int count) {
    for (int i = 0; i < count; ++i) writer_.number(0.0);
    return *this;
  }

  FieldWriter& pose(const Pose& pose) {
    return numbers(std::array<double, 7>{pose.p.x(), pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(),
                                         pose.q.z(), pose.q.w()});
  }

  [[nodiscard]] std::string take() {
    return format_ == WireFormat::kRos1 ? writer_.take() : std::string(kCdrLittleEndian) + writer_.take();
  }

 private:
  WireFormat format_;
  ByteWriter writer_;
};

constexpr std::string_view kHeader = "std_msgs/Header";
constexpr std::string_view kQuaternion = "geometry_msgs/Quaternion";
constexpr std::string_view kVector = "geometry_msgs/Vector3";

/// Own fields of a type, and the types of its parts.
struct TypeText {
  std::string_view type;
  std::string_view md5;  ///< of messages only
  std::string_view fields;
  std::array<std::string_view, 8> parts;
};

constexpr std::array<TypeText, 12> kMessageTexts{{
    {"sensor_msgs/Image",
     "060021388200f6f0f447d0fcd9c64743",
     "Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] "
     "data\n",
     {kHeader}},
    {"sensor_msgs/CompressedImage",
     "8f7a12909da2c9d3332d540a0977563f",
     "Header header\nstring format\nuint8[] data\n",
     {kHeader}},
    {"sensor_msgs/CameraInfo",
     "c9a58c1b0b154e0e6da7578cb991d214",
     "Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] D\nfloat64[9] "
     "K\nfloat64[9] R\n"
     "float64[12] P\nuint32 binning_x\nuint32 binning_y\nRegionOfInterest roi\n",
     {kHeader, "sensor_msgs/RegionOfInterest"}},
    {"sensor_msgs/Imu",
     "6a62c6daae103f4ff57a132d6f95cec2",
     "Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
     "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
     "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
     {kHeader, kQuaternion, kVector}},
    {"sensor_msgs/NavSatFix",
     "2d3a8cd499b9b4a0249fb98fd05cfa48",
     "Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n"
     "float64[9] position_covariance\nuint8 COVARIANCE_TYPE_UNKNOWN=0\nuint8 COVARIANCE_TYPE_APPROXIMATED=1\n"
     "uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\nuint8 COVARIANCE_TYPE_KNOWN=3\nuint8 "
     "position_covariance_type\n",
     {kHeader, "sensor_msgs/NavSatStatus"}},
    {"geometry_msgs/PoseStamped",
     "d3812c3cbc69362b77dc0b19b345f8f5",
     "Header header\nPose pose\n",
     {kHeader, "geometry_msgs/Pose", "geometry_msgs/Point", kQuaternion}},
    {"geometry_msgs/PoseWithCovarianceStamped",
     "953b798c0f514ff060a53a3498ce6246",
     "Header header\nPoseWithCovariance pose\n",
     {kHeader, "geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose", "geometry_msgs/Point", kQuaternion}},
    {"geometry_msgs/TransformStamped",
     "b5764a33bfeb3588febc2682852579b0",
     "Header header\nstring child_frame_id\nTransform transform\n",
     {kHeader, "geometry_msgs/Transform", kVector, kQuaternion}},
    {"nav_msgs/Odometry",
     "cd5e73d190d741a2f92e81eda573aca7",
     "Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance "
     "pose\ngeometry_msgs/TwistWithCovariance twist\n",
     {kHeader, "geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose", "geometry_msgs/Point", kQuaternion,
      "geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist", kVector}},
    {"geometry_msgs/Transform",
     "ac9eff44abf714214112b05d54a3cf9b",
     "Vector3 translation\nQuaternion rotation\n",
     {kVector, kQuaternion}},
    {"std_msgs/Float32", "73fcbf46b49191e672908e50842a83d4", "float32 data\n", {}},
    {"tf2_msgs/TFMessage",
     "94810edda583a504dfda3829e70d7eec",
     "geometry_msgs/TransformStamped[] transforms\n",
     {"geometry_msgs/TransformStamped", kHeader, "geometry_msgs/Transform", kVector, kQuaternion}},
}};

constexpr std::array<TypeText, 11> kPartTexts{{
    {kHeader, "", "uint32 seq\ntime stamp\nstring frame_id\n", {}},
    {kQuaternion, "", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n", {}},
    {kVector, "", "float64 x\nfloat64 y\nfloat64 z\n", {}},
    {"geometry_msgs/Point", "", "float64 x\nfloat64 y\nfloat64 z\n", {}},
    {"geometry_msgs/Pose", "", "Point position\nQuaternion orientation\n", {}},
    {"geometry_msgs/PoseWithCovariance", "", "Pose pose\nfloat64[36] covariance\n", {}},
    {"geometry_msgs/Transform", "", "Vector3 translation\nQuaternion rotation\n", {}},
    {"geometry_msgs/Twist", "", "Vector3 linear\nVector3 angular\n", {}},
    {"geometry_msgs/TwistWithCovariance", "", "Twist twist\nfloat64[36] covariance\n", {}},
    {"sensor_msgs/RegionOfInterest",
     "",
     "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n",
     {}},
    {"sensor_msgs/NavSatStatus",
     "",
     "int8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 STATUS_SBAS_FIX=1\nint8 STATUS_GBAS_FIX=2\nint8 status\n"
     "uint16 SERVICE_GPS=1\nuint16 SERVICE_GLONASS=2\nuint16 SERVICE_COMPASS=4\nuint16 "
     "SERVICE_GALILEO=8\nuint16 service\n",
     {}},
}};

template <class Texts>
const TypeText& find_text(const Texts& texts, std::string_view type) {
  for (const TypeText& text : texts) {
    if (text.type == type) return text;
  }
  STILLPOINT_CHECK(false && "a type without definition");
  return texts.front();
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

/// The fields in ROS 2: times have another name, the header has no number, arrays of CameraInfo are lower
/// case.
std::string ros2_fields(const TypeText& text) {
  if (text.type == kHeader) return "builtin_interfaces/Time stamp\nstring frame_id\n";
  if (text.type == "geometry_msgs/TransformStamped" || !text.md5.empty()) {
    std::string fields = replaced(std::string(text.fields), "Header header", "std_msgs/Header header");
    for (const char name : {'D', 'K', 'R', 'P'}) {
      const std::string upper = std::string("] ") + name + "\n";
      fields = replaced(fields, upper, std::string("] ") + static_cast<char>(name - 'A' + 'a') + "\n");
    }
    return fields;
  }
  return std::string(text.fields);
}

std::string part_text(std::string_view type, WireFormat format) {
  const bool is_message = type == "geometry_msgs/TransformStamped";
  const TypeText& text = is_message ? find_text(kMessageTexts, type) : find_text(kPartTexts, type);
  std::string result = std::string(80, '=') + "\nMSG: " + std::string(type) + "\n";
  result += format == WireFormat::kRos1 ? std::string(text.fields) : ros2_fields(text);
  if (format == WireFormat::kCdr && type == kHeader)
    result += std::string(80, '=') + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
  return result;
}

}  // namespace

std::string serialize(const ImuMessage& message, WireFormat format) {
  FieldWriter fields(format);
  fields.header(message.header).numbers(std::array<double, 4>{0.0, 0.0, 0.0, 1.0});
  fields.numbers(std::array<double, 9>{-1.0}).numbers(message.gyro).zeros(9).numbers(message.accel).zeros(9);
  return fields.take();
}

std::string serialize(const ImageMessage& message, WireFormat format) {
  FieldWriter fields(format);
  fields.header(message.header).writer().number(message.height).number(message.width).text(message.encoding);
  fields.writer()
      .number(static_cast<std::uint8_t>(message.big_endian))
      .number(message.step)
      .block(message.data);
  return fields.take();
}

std::string serialize(const CompressedImageMessage& message, WireFormat format) {
  FieldWriter fields(format);
  fields.header(message.header).writer().text(message.format).block(message.data);
  return fields.take();
}

std::string serialize(const CameraInfoMessage& message, WireFormat format) {
  FieldWriter fields(format);
  fields.header(message.header)
      .writer()
      .number(message.height)
      .number(message.width)
      .text(message.distortion_model);
  fields.writer().number(static_cast<std::uint32_t>(message.D.size()));
  fields.numbers(message.D)
      .numbers(message.K)
      .numbers(std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1})
      .numbers(message.P);
  for (int i = 0; i < 6; ++i) fields.writer().number(std::uint32_t{0});  // binning, region of interest
  fields.writer().number(std::uint8_t{0});
  return fields.take();
}

std::string serialize(const NavSatFixMessage& message, WireFormat format) {
  FieldWriter fields(format);
  fields.header(message.header)
      .writer()
      .number(static_cast<std::int8_t>(message.status))
      .number(std::uint16_t{1});
  fields.numbers(std::array<double, 3>{message.latitude_deg, message.longitude_deg, message.altitude_m})
      .zeros(9);
  fields.writer().number(std::uint8_t{0});
  return fields.take();
}

std::string serialize_pose(const PoseMessage& message, std::string_view type, WireFormat format) {
  FieldWriter fields(format);
  fields.header(message.header);
  if (type == "geometry_msgs/TransformStamped" || type == "nav_msgs/Odometry")
    fields.writer().text(message.child);
  fields.pose(message.pose.value());
  if (type == "geometry_msgs/PoseWithCovarianceStamped" || type == "nav_msgs/Odometry") {
    for (const double value : message.covariance.value_or(std::array<double, kPoseCovariance>{}))
      fields.writer().number(value);
  }
  if (type == "nav_msgs/Odometry") fields.zeros(kPoseCovariance + 6);  // velocities
  return fields.take();
}

std::string serialize_transform(const Pose& pose, WireFormat format) {
  return FieldWriter(format).pose(pose).take();
}

std::string serialize_float(float value, WireFormat format) {
  FieldWriter fields(format);
  fields.writer().number(value);
  return fields.take();
}

std::string serialize_transforms(std::span<const PoseMessage> transforms, WireFormat format) {
  FieldWriter fields(format);
  fields.writer().number(static_cast<std::uint32_t>(transforms.size()));
  for (const PoseMessage& transform : transforms) {
    fields.header(transform.header).writer().text(transform.child);
    fields.pose(transform.pose.value());
  }
  return fields.take();
}

MessageDefinition definition_of(std::string_view type, WireFormat format) {
  const TypeText& message = find_text(kMessageTexts, type);
  std::string text = format == WireFormat::kRos1 ? std::string(message.fields) : ros2_fields(message);
  for (const std::string_view part : message.parts) {
    if (!part.empty()) text += part_text(part, format);
  }
  return {.type = message.type, .md5 = message.md5, .text = text};
}

}  // namespace stillpoint::datasets
