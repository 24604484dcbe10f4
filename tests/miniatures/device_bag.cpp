// SPDX-License-Identifier: BSD-3-Clause
/// Writes a sequence as a ROS 1 bag like those of other recorders:
///   vcu_rvi        color as 8UC3 (B, G, R) on /cam0/color, depth as 16UC1 on /cam0/depth, accelerations in g
///   with
///                  inverted sign on /imu, neither CameraInfo nor transforms: the camera is in FILE.rig.toml,
///                  as a user writes it. The topic of the ground truth is that of exported bags.
///   librealsense   streams below /device_0 with their calibration; no ground truth
/// Recorded boxes, if there are any, are written beside the bag.
///   device_bag vcu_rvi|librealsense SEQUENCE FILE.bag
#include <cstdio>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>

#include "datasets/bags/bag_chunks.h"
#include "datasets/bags/bag_file.h"
#include "datasets/bags/messages.h"
#include "datasets/calibration/rig_file.h"
#include "datasets/io/detections_file.h"
#include "datasets/open_sequence.h"
#include "eval/io/text_reader.h"

namespace stillpoint::datasets {
namespace {

constexpr double kGravity = 9.80665;  ///< [m/s^2] of 1 g
constexpr WireFormat kFormat = WireFormat::kRos1;

/// Names and encodings of the images.
struct ImageTopics {
  std::string color, depth;
  std::string color_encoding, depth_encoding;
  std::string frame;
};

std::string image_message(const MessageHeader& header, const cv::Mat& image, const std::string& encoding) {
  const cv::Mat pixels = image.clone();  // continuous
  const std::size_t row_bytes = static_cast<std::size_t>(pixels.cols) * pixels.elemSize();
  return serialize(ImageMessage{.header = header,
                                .height = static_cast<std::uint32_t>(pixels.rows),
                                .width = static_cast<std::uint32_t>(pixels.cols),
                                .encoding = encoding,
                                .step = static_cast<std::uint32_t>(row_bytes),
                                .data = {reinterpret_cast<const char*>(pixels.data),
                                         row_bytes * static_cast<std::size_t>(pixels.rows)}},
                   kFormat);
}

cv::Mat swapped_channels(const cv::Mat& rgb) {
  cv::Mat bgr = rgb.clone();
  for (auto pixel = bgr.begin<cv::Vec3b>(); pixel != bgr.end<cv::Vec3b>(); ++pixel)
    std::swap((*pixel)[0], (*pixel)[2]);
  return bgr;
}

void write_frames(BagWriter& bag, const SensorStream& stream, const ImageTopics& topics) {
  const std::uint32_t color = bag.add_connection(topics.color, "sensor_msgs/Image");
  const std::uint32_t depth = bag.add_connection(topics.depth, "sensor_msgs/Image");
  const bool bgr = topics.color_encoding == "8UC3";
  for (std::size_t i = 0; i < stream.info().frame_times.size(); ++i) {
    const Frame frame = stream.load_frame(i);
    const MessageHeader header{.stamp = frame.t, .frame = topics.frame};
    const cv::Mat rgb = color_image(frame);
    bag.write(color, frame.t,
              image_message(header, bgr ? swapped_channels(rgb) : rgb, topics.color_encoding));
    bag.write(depth, frame.t, image_message(header, frame.depth, topics.depth_encoding));
  }
}

/// Writes one message with the time of the first frame.
void write_once(BagWriter& bag, const SequenceInfo& info, const std::string& topic, const std::string& type,
                const std::string& bytes) {
  bag.write(bag.add_connection(topic, type), info.frame_times.front(), bytes);
}

void write_vcu_rvi(BagWriter& bag, const SensorStream& stream) {
  write_frames(bag, stream, {"/cam0/color", "/cam0/depth", "8UC3", "16UC1", "cam0"});
  const SequenceInfo& info = stream.info();
  const std::uint32_t imu = bag.add_connection("/imu", "sensor_msgs/Imu");
  for (const ImuSample& sample : info.imu) {
    const ImuMessage message{.header = {.stamp = sample.t, .frame = "imu"},
                             .gyro = sample.gyro_b,
                             .accel = -sample.accel_b / kGravity};
    bag.write(imu, sample.t, serialize(message, kFormat));
  }
  constexpr std::string_view kPoseType = "geometry_msgs/TransformStamped";
  const std::uint32_t truth = bag.add_connection("/ground_truth", kPoseType);
  for (const StampedPose& pose : info.ground_truth.trajectory.poses) {
    const PoseMessage message{.header = {.stamp = pose.t, .frame = "world"},
                              .child = "cam0",
                              .pose = pose.T_w_f * info.ground_truth.T_c_f.inverse()};
    bag.write(truth, pose.t, serialize_pose(message, kPoseType, kFormat));
  }
}

void write_librealsense(BagWriter& bag, const SensorStream& stream) {
  const std::string depth = "/device_0/sensor_0/Depth_0", color = "/device_0/sensor_1/Color_0";
  const std::string gyro = "/device_0/sensor_2/Gyro_0", accel = "/device_0/sensor_2/Accel_0";
  const SequenceInfo& info = stream.info();
  const Camera& camera = info.rig.camera;
  const CameraInfoMessage calibration{
      .header = {.stamp = info.frame_times.front(), .frame = "0"},
      .height = static_cast<std::uint32_t>(camera.height),
      .width = static_cast<std::uint32_t>(camera.width),
      .distortion_model = "plumb_bob",
      .D = std::vector<double>(camera.coefficients().begin(), camera.coefficients().end()),
      .K = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1},
      .P = {}};
  for (const std::string& topic : {depth, color}) {
    write_once(bag, info, topic + "/info/camera_info", "sensor_msgs/CameraInfo",
               serialize(calibration, kFormat));
    write_once(bag, info, topic + "/tf/0", "geometry_msgs/Transform", serialize_transform(Pose{}, kFormat));
  }
  write_once(bag, info, gyro + "/tf/0", "geometry_msgs/Transform",
             serialize_transform(info.rig.T_b_c.inverse(), kFormat));
  write_once(bag, info, "/device_0/sensor_0/option/Depth_Units/value", "std_msgs/Float32",
             serialize_float(static_cast<float>(1.0 / info.rig.depth_units_per_m), kFormat));
  write_frames(bag, stream, {color + "/image/data", depth + "/image/data", "rgb8", "mono16", "0"});
  const std::uint32_t rates = bag.add_connection(gyro + "/imu/data", "sensor_msgs/Imu");
  const std::uint32_t forces = bag.add_connection(accel + "/imu/data", "sensor_msgs/Imu");
  for (const ImuSample& sample : info.imu) {
    ImuMessage message{.header = {.stamp = sample.t, .frame = "0"}, .gyro = sample.gyro_b};
    bag.write(rates, sample.t, serialize(message, kFormat));
    message.gyro.setZero();
    message.accel = sample.accel_b;
    bag.write(forces, sample.t, serialize(message, kFormat));
  }
}

void write_bag(const std::string& kind, const std::filesystem::path& sequence,
               const std::filesystem::path& file) {
  const auto stream = open_sequence(sequence);
  const SequenceInfo& info = stream->info();
  BagWriter bag(file, ChunkCompression::kLz4);
  if (kind == "vcu_rvi") {
    write_vcu_rvi(bag, *stream);
    eval::write_text_file(companion_file(file, "rig.toml"), rig_file_text(info.rig));
  } else {
    write_librealsense(bag, *stream);
  }
  bag.finish();
  if (!info.detections.empty())
    eval::write_text_file(companion_file(file, "detections.txt"), detections_text(info.detections));
}

}  // namespace
}  // namespace stillpoint::datasets

int main(int argc, char** argv) {
  const std::string kind = argc == 4 ? argv[1] : "";
  if (kind != "vcu_rvi" && kind != "librealsense") {
    std::fputs("usage: device_bag vcu_rvi|librealsense SEQUENCE FILE.bag\n", stderr);
    return 2;
  }
  try {
    stillpoint::datasets::write_bag(kind, argv[2], argv[3]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
