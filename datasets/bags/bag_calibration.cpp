// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/bag_calibration.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

constexpr std::string_view kCameraInfo = "sensor_msgs/CameraInfo";
constexpr std::size_t kMaxDistortion = 5;  ///< coefficients of `Camera`

/// "/camera/color" of "/camera/color/image_raw/compressed".
std::string camera_name(std::string topic) {
  for (const std::string_view transport : {"/compressedDepth", "/compressed"}) {
    if (topic.ends_with(transport)) topic.resize(topic.size() - transport.size());
  }
  return topic.substr(0, topic.rfind('/'));
}

std::optional<CameraInfoMessage> calibrated(const BagFile& bag, const MessageReference& reference) {
  const std::string bytes = bag.payload(reference);
  const std::string place = bag.place(reference);
  const CameraInfoMessage info =
      parse_camera_info({.bytes = bytes, .format = bag.connection(reference).format, .place = place});
  return info.K[0] > 0.0 && info.K[4] > 0.0 ? std::optional(info) : std::nullopt;
}

/// The model of OpenCV with 8 coefficients has three more of a denominator.
bool has_only_radial_tangential(const CameraInfoMessage& info) {
  return std::all_of(info.D.begin() + static_cast<std::ptrdiff_t>(std::min(kMaxDistortion, info.D.size())),
                     info.D.end(), [](double coefficient) { return coefficient == 0.0; });
}

}  // namespace

std::optional<CameraInfoMessage> find_camera_info(const BagFile& bag, const std::string& image_topic,
                                                  const std::string& image_frame) {
  const std::string beside = camera_name(image_topic) + "/camera_info";
  const std::string of_stream = realsense_stream(image_topic).value_or("") + "/info/camera_info";
  std::set<std::string> seen;
  std::optional<CameraInfoMessage> of_frame;
  for (const MessageReference& reference : bag.messages()) {
    const BagConnection& connection = bag.connection(reference);
    if (connection.type != kCameraInfo || !seen.insert(connection.topic).second) continue;
    const std::optional<CameraInfoMessage> info = calibrated(bag, reference);
    if (connection.topic == beside || connection.topic == of_stream) return info;
    if (info && !of_frame && !image_frame.empty() && info->header.frame == image_frame) of_frame = info;
  }
  return of_frame;
}

Camera camera_of(const CameraInfoMessage& info, const std::string& image_topic, const std::string& place) {
  Camera camera{.width = static_cast<int>(info.width),
                .height = static_cast<int>(info.height),
                .fx = info.K[0],
                .fy = info.K[4],
                .cx = info.K[2],
                .cy = info.K[5]};
  if (image_topic.find("rect") != std::string::npos && info.P[0] > 0.0) {
    camera.fx = info.P[0];
    camera.fy = info.P[5];
    camera.cx = info.P[2];
    camera.cy = info.P[6];
    return camera;
  }
  if (std::ranges::all_of(info.D, [](double coefficient) { return coefficient == 0.0; })) return camera;
  const std::string& model = info.distortion_model;
  if (model == "equidistant" || model == "fisheye" || model == "kannala_brandt4" ||
      model == "kannala_brandt") {
    camera.model = CameraModel::kKannalaBrandt;
  } else if (!(model == "plumb_bob" || model == "radial-tangential" || model == "Brown Conrady" ||
               model == "brown_conrady" || model.empty() ||
               (model == "rational_polynomial" && has_only_radial_tangential(info)))) {
    throw InputError(place, "the distortion model \"" + model +
                                "\" is not supported; calibrate the camera as plumb_bob or equidistant and "
                                "write it to a rig.toml");
  }
  std::copy_n(info.D.begin(), std::min(info.D.size(), kMaxDistortion), camera.distortion.begin());
  return camera;
}

std::optional<std::string> realsense_stream(const std::string& topic) {
  if (!topic.starts_with("/device_")) return std::nullopt;
  const std::size_t sensor = topic.find("/sensor_", 1);
  const std::size_t stream = sensor == std::string::npos ? sensor : topic.find('/', sensor + 1);
  if (stream == std::string::npos) return std::nullopt;
  return topic.substr(0, topic.find('/', stream + 1));
}

RealsenseStreams read_realsense_streams(const BagFile& bag) {
  RealsenseStreams streams;
  for (const MessageReference& reference : bag.messages()) {
    const BagConnection& connection = bag.connection(reference);
    const bool is_extrinsic = connection.type == "geometry_msgs/Transform";
    // Written with a space or an underscore, depending on the version.
    const bool is_unit = connection.type == "std_msgs/Float32" &&
                         (connection.topic.find("Depth Units/value") != std::string::npos ||
                          connection.topic.find("Depth_Units/value") != std::string::npos);
    const std::optional<std::string> stream = realsense_stream(connection.topic);
    if (!stream || (!is_extrinsic && !is_unit)) continue;
    const std::string bytes = bag.payload(reference);
    const std::string place = bag.place(reference);
    const SerializedMessage message{.bytes = bytes, .format = connection.format, .place = place};
    if (is_unit) {
      const double meters = parse_float(message);
      if (meters > 0.0) streams.depth_units_per_m = 1.0 / meters;
    } else if (const std::optional<Pose> pose = parse_transform(message)) {
      streams.links.push_back({.parent = connection.topic.substr(connection.topic.rfind('/') + 1),
                               .child = *stream,
                               .T_parent_child = *pose});
    }
  }
  return streams;
}

}  // namespace stillpoint::datasets
