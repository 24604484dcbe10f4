// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/foxglove/message_types.h"

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "core/base/error.h"
#include "datasets/foxglove/protobuf.h"

namespace stillpoint::datasets {
namespace {

struct MessageField {
  int number = 0;
  std::string_view name;
  std::string_view type;  ///< scalar type, or the full name of a message or enumeration
  bool repeated = false;
};

struct MessageType {
  std::string_view package;
  std::string_view name;
  std::vector<MessageField> fields;
  std::string_view enumeration = {};               ///< nested in the message; empty = none
  std::vector<std::string_view> enumerators = {};  ///< numbered from 0
};

constexpr std::string_view kTimestamp = "google.protobuf.Timestamp";
constexpr std::string_view kVector3 = "foxglove.Vector3";
constexpr std::string_view kPose = "foxglove.Pose";
constexpr std::string_view kPoint2 = "foxglove.Point2";
constexpr std::string_view kColor = "foxglove.Color";

std::vector<MessageType> geometry_types() {
  return {{"google.protobuf", "Timestamp", {{1, "seconds", "int64"}, {2, "nanos", "int32"}}},
          {"foxglove", "Vector3", {{1, "x", "double"}, {2, "y", "double"}, {3, "z", "double"}}},
          {"foxglove",
           "Quaternion",
           {{1, "x", "double"}, {2, "y", "double"}, {3, "z", "double"}, {4, "w", "double"}}},
          {"foxglove", "Pose", {{1, "position", kVector3}, {2, "orientation", "foxglove.Quaternion"}}},
          {"foxglove",
           "PoseInFrame",
           {{1, "timestamp", kTimestamp}, {2, "frame_id", "string"}, {3, "pose", kPose}}},
          {"foxglove",
           "PosesInFrame",
           {{1, "timestamp", kTimestamp}, {2, "frame_id", "string"}, {3, "poses", kPose, true}}},
          {"foxglove",
           "FrameTransform",
           {{1, "timestamp", kTimestamp},
            {2, "parent_frame_id", "string"},
            {3, "child_frame_id", "string"},
            {4, "translation", kVector3},
            {5, "rotation", "foxglove.Quaternion"}}},
          {"foxglove",
           "PackedElementField",
           {{1, "name", "string"},
            {2, "offset", "fixed32"},
            {3, "type", "foxglove.PackedElementField.NumericType"}},
           "NumericType",
           {"UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64"}},
          {"foxglove",
           "PointCloud",
           {{1, "timestamp", kTimestamp},
            {2, "frame_id", "string"},
            {3, "pose", kPose},
            {4, "point_stride", "fixed32"},
            {5, "fields", "foxglove.PackedElementField", true},
            {6, "data", "bytes"}}}};
}

std::vector<MessageType> image_types() {
  return {
      {"foxglove",
       "CameraCalibration",
       {{1, "timestamp", kTimestamp},
        {9, "frame_id", "string"},
        {2, "width", "fixed32"},
        {3, "height", "fixed32"},
        {4, "distortion_model", "string"},
        {5, "D", "double", true},
        {6, "K", "double", true},
        {7, "R", "double", true},
        {8, "P", "double", true}}},
      {"foxglove",
       "CompressedImage",
       {{1, "timestamp", kTimestamp},
        {4, "frame_id", "string"},
        {2, "data", "bytes"},
        {3, "format", "string"}}},
      {"foxglove",
       "RawImage",
       {{1, "timestamp", kTimestamp},
        {7, "frame_id", "string"},
        {2, "width", "fixed32"},
        {3, "height", "fixed32"},
        {4, "encoding", "string"},
        {5, "step", "fixed32"},
        {6, "data", "bytes"}}},
  };
}

std::vector<MessageType> annotation_types() {
  return {
      {"foxglove", "Point2", {{1, "x", "double"}, {2, "y", "double"}}},
      {"foxglove", "Color", {{1, "r", "double"}, {2, "g", "double"}, {3, "b", "double"}, {4, "a", "double"}}},
      {"foxglove",
       "PointsAnnotation",
       {{1, "timestamp", kTimestamp},
        {2, "type", "foxglove.PointsAnnotation.Type"},
        {3, "points", kPoint2, true},
        {4, "outline_color", kColor},
        {5, "outline_colors", kColor, true},
        {6, "fill_color", kColor},
        {7, "thickness", "double"}},
       "Type",
       {"UNKNOWN", "POINTS", "LINE_LOOP", "LINE_STRIP", "LINE_LIST"}},
      {"foxglove",
       "TextAnnotation",
       {{1, "timestamp", kTimestamp},
        {2, "position", kPoint2},
        {3, "text", "string"},
        {4, "font_size", "double"},
        {5, "text_color", kColor},
        {6, "background_color", kColor}}},
      {"foxglove",
       "CircleAnnotation",
       {{1, "timestamp", kTimestamp},
        {2, "position", kPoint2},
        {3, "diameter", "double"},
        {4, "thickness", "double"},
        {5, "fill_color", kColor},
        {6, "outline_color", kColor}}},
      {"foxglove",
       "ImageAnnotations",
       {{1, "circles", "foxglove.CircleAnnotation", true},
        {2, "points", "foxglove.PointsAnnotation", true},
        {3, "texts", "foxglove.TextAnnotation", true}}}};
}

std::vector<MessageType> odometry_types() {
  return {
      {"stillpoint",
       "Status",
       {{1, "timestamp", kTimestamp},
        {2, "frame", "int64"},
        {3, "status", "string"},
        {4, "reason", "string"},
        {5, "segment", "int32"},
        {6, "tracked_features", "int32"},
        {7, "window_landmarks", "int32"},
        {8, "depth_landmarks", "int32"},
        {9, "dynamic_features", "int32"},
        {10, "solver_iterations", "int32"},
        {11, "keyframe", "bool"},
        {12, "reset", "bool"}}},
      {"stillpoint",
       "State",
       {{1, "timestamp", kTimestamp},
        {2, "frame_id", "string"},
        {3, "pose", kPose},
        {4, "velocity", kVector3},
        {5, "gyro_bias", kVector3},
        {6, "accel_bias", kVector3},
        {7, "time_offset_s", "double"},
        {8, "depth_scale", "double"},
        {9, "pose_covariance", "double", true}}},
      {"stillpoint", "ModuleTime", {{1, "module", "string"}, {2, "ms", "double"}, {3, "calls", "int32"}}},
      {"stillpoint",
       "Timings",
       {{1, "timestamp", kTimestamp}, {2, "frame", "int64"}, {3, "modules", "stillpoint.ModuleTime", true}}},
      {"stillpoint",
       "Imu",
       {{1, "timestamp", kTimestamp},
        {2, "angular_velocity", kVector3},
        {3, "linear_acceleration", kVector3}}},
      {"stillpoint",
       "Claim",
       {{1, "timestamp", kTimestamp},
        {2, "frame", "int64"},
        {3, "status", "string"},
        {4, "segment", "int32"},
        {5, "sigma_m", "double"},
        {6, "sigma_rad", "double"}}},
      {"stillpoint",
       "Loop",
       {{1, "timestamp", kTimestamp},
        {2, "frame", "int64"},
        {3, "match_timestamp", kTimestamp},
        {4, "match_frame", "int64"},
        {5, "votes", "int32"},
        {6, "matches", "int32"},
        {7, "inliers", "int32"},
        {8, "residual_px", "double"},
        {9, "outcome", "string"},
        {10, "in_map", "bool"},
        {11, "pose_in_match", kPose}}}};
}

/// All types by their full names.
std::map<std::string, MessageType, std::less<>> all_message_types() {
  std::map<std::string, MessageType, std::less<>> types;
  for (const auto& group : {geometry_types(), image_types(), annotation_types(), odometry_types()}) {
    for (const MessageType& type : group)
      types.emplace(std::string(type.package) + "." + std::string(type.name), type);
  }
  return types;
}

/// Numbers of google.protobuf.FieldDescriptorProto.Type.
constexpr std::int64_t kMessageField = 11;
constexpr std::int64_t kEnumField = 14;

std::int64_t type_number(std::string_view type, bool is_message) {
  static constexpr std::pair<std::string_view, std::int64_t> kScalars[] = {
      {"double", 1}, {"int64", 3}, {"int32", 5}, {"fixed32", 7}, {"bool", 8}, {"string", 9}, {"bytes", 12}};
  const auto* const found =
      std::ranges::find(kScalars, type, &std::pair<std::string_view, std::int64_t>::first);
  if (found != std::end(kScalars)) return found->second;
  return is_message ? kMessageField : kEnumField;
}

/// An encoded google.protobuf.DescriptorProto.
std::string message_descriptor(const MessageType& message, const std::set<std::string>& messages) {
  constexpr std::int64_t kOptional = 1;
  constexpr std::int64_t kRepeated = 3;
  ProtobufWriter descriptor;
  descriptor.bytes(1, message.name);
  for (const MessageField& field : message.fields) {
    const std::int64_t type = type_number(field.type, messages.contains(std::string(field.type)));
    ProtobufWriter writer;
    writer.bytes(1, field.name).integer(3, field.number).integer(4, field.repeated ? kRepeated : kOptional);
    writer.integer(5, type);
    if (type == kMessageField || type == kEnumField) writer.bytes(6, "." + std::string(field.type));
    descriptor.bytes(2, writer.take());
  }
  if (message.enumeration.empty()) return descriptor.take();
  ProtobufWriter enumeration;
  enumeration.bytes(1, message.enumeration);
  for (std::size_t i = 0; i < message.enumerators.size(); ++i) {
    enumeration.bytes(
        2, ProtobufWriter().bytes(1, message.enumerators[i]).integer(2, static_cast<std::int64_t>(i)).take());
  }
  return descriptor.bytes(4, enumeration.take()).take();
}

std::string file_of_package(std::string_view package) { return std::string(package) + ".proto"; }

}  // namespace

std::string protobuf_schema(std::string_view type) {
  const auto types = all_message_types();
  STILLPOINT_CHECK(types.contains(type));
  std::set<std::string> included;
  std::vector<std::string> added = {std::string(type)};
  while (!added.empty()) {
    const auto found = types.find(added.back());
    added.pop_back();
    if (found == types.end() || !included.insert(found->first).second) continue;
    for (const MessageField& field : found->second.fields) added.emplace_back(field.type);
  }
  ProtobufWriter files;
  std::vector<std::string> earlier;
  for (const std::string_view package : {"google.protobuf", "foxglove", "stillpoint"}) {
    ProtobufWriter file;
    file.bytes(1, file_of_package(package)).bytes(2, package);
    for (const std::string& dependency : earlier) file.bytes(3, dependency);
    bool any = false;
    for (const std::string& name : included) {
      const MessageType& message = types.find(name)->second;
      if (message.package != package) continue;
      file.bytes(4, message_descriptor(message, included));
      any = true;
    }
    if (!any) continue;
    files.bytes(1, file.bytes(12, "proto3").take());
    earlier.push_back(file_of_package(package));
  }
  return files.take();
}

}  // namespace stillpoint::datasets
