// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <system_error>

#include "core/base/error.h"
#include "datasets/bags/chunk_codec.h"
#include "datasets/bags/image_message.h"
#include "datasets/bags/writing/bag_writer.h"
#include "datasets/bags/writing/serialize.h"
#include "datasets/calibration/rig_file.h"
#include "datasets/io/detections_file.h"
#include "datasets/read_sequence.h"
#include "datasets/sequence_export.h"
#include "eval/io/text_reader.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCameraFrame = "camera_color_optical_frame";
constexpr const char* kImuFrame = "camera_imu_optical_frame";
constexpr double kMillimeters = 1000.0;  ///< units per meter of 16UC1

std::string_view bytes_of(const cv::Mat& continuous) {
  return {reinterpret_cast<const char*>(continuous.data), continuous.total() * continuous.elemSize()};
}

/// Writes the streams of a sequence in the order of time.
class BagExporter {
 public:
  BagExporter(const SensorStream& stream, const fs::path& path, ChunkCompression compression)
      : stream_(stream),
        info_(stream.info()),
        writer_(path, compression),
        color_(writer_.add_connection("/camera/color/image_raw", "sensor_msgs/Image")),
        color_info_(writer_.add_connection("/camera/color/camera_info", "sensor_msgs/CameraInfo")),
        depth_(writer_.add_connection("/camera/aligned_depth_to_color/image_raw", "sensor_msgs/Image")),
        depth_info_(
            writer_.add_connection("/camera/aligned_depth_to_color/camera_info", "sensor_msgs/CameraInfo")),
        imu_(writer_.add_connection("/camera/imu", "sensor_msgs/Imu")),
        truth_(writer_.add_connection("/ground_truth", "geometry_msgs/TransformStamped")),
        static_(writer_.add_connection("/tf_static", "tf2_msgs/TFMessage")) {}

  void run(const ExportControl& control) {
    if (info_.rig.has_imu) write_extrinsic();
    for (std::size_t i = 0; i < info_.frame_times.size(); ++i) {
      if (control.stop_requested && control.stop_requested())
        throw InputError("was interrupted; partial output was removed");
      write_samples_until(info_.frame_times[i]);
      write_frame(stream_.load_frame(i));
      if (control.progress) control.progress(i + 1, info_.frame_times.size());
    }
    write_samples_until(Timestamp{INT64_MAX});
    writer_.finish();
  }

 private:
  void write_extrinsic() {
    const PoseMessage extrinsic{
        .header = {.stamp = start(), .frame = kImuFrame}, .child = kCameraFrame, .pose = info_.rig.T_b_c};
    writer_.write(static_, start(), serialize_transforms(std::span(&extrinsic, 1), writer_.format()));
  }

  [[nodiscard]] Timestamp start() const {
    return info_.imu.empty() ? info_.frame_times.front()
                             : std::min(info_.frame_times.front(), info_.imu.front().t);
  }

  /// Inertial samples and poses before a frame.
  void write_samples_until(Timestamp end) {
    for (; next_imu_ < info_.imu.size() && info_.imu[next_imu_].t < end; ++next_imu_) {
      const ImuSample& sample = info_.imu[next_imu_];
      const ImuMessage message{
          .header = {.stamp = sample.t, .frame = kImuFrame}, .gyro = sample.gyro_b, .accel = sample.accel_b};
      writer_.write(imu_, sample.t, serialize(message, writer_.format()));
    }
    const std::vector<StampedPose>& poses = info_.ground_truth.trajectory.poses;
    for (; next_pose_ < poses.size() && poses[next_pose_].t < end; ++next_pose_) {
      const StampedPose& pose = poses[next_pose_];
      const PoseMessage message{.header = {.stamp = pose.t, .frame = "world"},
                                .child = kCameraFrame,
                                .pose = pose.T_w_f * info_.ground_truth.T_c_f.inverse()};
      writer_.write(truth_, pose.t,
                    serialize_pose(message, "geometry_msgs/TransformStamped", writer_.format()));
    }
  }

  void write_frame(const Frame& frame) {
    const cv::Mat color = color_image(frame);
    write_image(color_, frame.t, color.empty() ? frame.gray : color, color.empty() ? "mono8" : "rgb8");
    writer_.write(color_info_, frame.t, camera_info(frame.t));
    if (frame.depth.empty()) return;
    if (frame.depth_units_per_m == kMillimeters) {
      write_image(depth_, frame.t, frame.depth, "16UC1");
    } else {
      cv::Mat meters;
      frame.depth.convertTo(meters, CV_32FC1, 1.0 / frame.depth_units_per_m);
      write_image(depth_, frame.t, meters, "32FC1");
    }
    writer_.write(depth_info_, frame.t, camera_info(frame.t));
  }

  void write_image(std::uint32_t connection, Timestamp t, const cv::Mat& image, const std::string& encoding) {
    const cv::Mat continuous = image.isContinuous() ? image : image.clone();
    const ImageMessage message{
        .header = {.stamp = t, .frame = kCameraFrame},
        .height = static_cast<std::uint32_t>(image.rows),
        .width = static_cast<std::uint32_t>(image.cols),
        .encoding = encoding,
        .big_endian = false,
        .step = static_cast<std::uint32_t>(static_cast<std::size_t>(image.cols) * image.elemSize()),
        .data = bytes_of(continuous)};
    writer_.write(connection, t, serialize(message, writer_.format()));
  }

  [[nodiscard]] std::string camera_info(Timestamp t) const {
    const Camera& camera = info_.rig.camera;
    const bool fisheye = camera.model == CameraModel::kKannalaBrandt;
    const CameraInfoMessage message{
        .header = {.stamp = t, .frame = kCameraFrame},
        .height = static_cast<std::uint32_t>(camera.height),
        .width = static_cast<std::uint32_t>(camera.width),
        .distortion_model = fisheye ? "equidistant" : "plumb_bob",
        .D = std::vector<double>(camera.distortion.begin(), camera.distortion.end() - (fisheye ? 1 : 0)),
        .K = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1},
        .P = {camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0}};
    return serialize(message, writer_.format());
  }

  const SensorStream& stream_;
  const SequenceInfo& info_;
  BagWriter writer_;
  std::uint32_t color_, color_info_, depth_, depth_info_, imu_, truth_, static_;  ///< connections
  std::size_t next_imu_ = 0;
  std::size_t next_pose_ = 0;
};

/// The rig as far as the bag does not contain it. The unit of depth follows from its encoding.
std::string companion_rig(Rig rig) {
  if (rig.depth_units_per_m != kMillimeters) rig.depth_units_per_m = kFloatDepthUnitsPerM;
  return rig_file_text(rig, false);
}

}  // namespace

void export_bag(const SensorStream& stream, const fs::path& path, const std::string& compression,
                const ExportControl& control) {
  const std::optional<ChunkCompression> method = compression_of(compression);
  if (!method)
    throw InputError("compression \"" + compression + "\"", "is unknown; expected none, bz2, lz4 or zstd");
  std::error_code ignored;
  if (fs::exists(path, ignored)) throw InputError(path.string(), "exists; choose another name or remove it");
  BagExporter(stream, path, *method).run(control);
  eval::write_text_file(companion_file(path, "rig.toml"), companion_rig(stream.info().rig));
  if (!stream.info().detections.empty())
    eval::write_text_file(companion_file(path, "detections.txt"), detections_text(stream.info().detections));
}

}  // namespace stillpoint::datasets
