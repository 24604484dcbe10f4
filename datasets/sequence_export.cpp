// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sequence_export.h"

#include <unistd.h>

#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <system_error>

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/bags/bag_file.h"
#include "datasets/bags/bag_topics.h"
#include "datasets/bags/messages.h"
#include "datasets/calibration/rig_file.h"
#include "datasets/io/detections_file.h"
#include "datasets/io/image_io.h"
#include "datasets/read_sequence.h"
#include "eval/io/text_reader.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

/// Calls `fill` on a temporary folder, then renames it to `folder`.
void write_atomically(const fs::path& folder, const std::function<void(const fs::path&)>& fill) {
  const fs::path unfinished = folder.string() + "." + std::to_string(getpid());
  try {
    fs::create_directories(unfinished);
    fill(unfinished);
    fs::rename(unfinished, folder);
  } catch (const std::exception& error) {
    std::error_code ignored;
    fs::remove_all(unfinished, ignored);
    if (fs::is_directory(folder)) return;  // a concurrent process has finished the same export
    throw InputError(folder.string(), std::string("cannot be exported: ") + error.what());
  }
}

void report_frame(const ExportControl& control, std::size_t done, std::size_t total) {
  if (control.stop_requested && control.stop_requested())
    throw InputError("was interrupted; partial output was removed");
  if (control.progress) control.progress(done, total);
}

/// The recorded boxes, which every format reads from this file.
void write_boxes(const SequenceInfo& info, const fs::path& folder) {
  if (!info.detections.empty())
    eval::write_text_file(folder / "detections.txt", detections_text(info.detections));
}

std::string matrix_text(const Pose& pose) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = pose.matrix();
  return fmt::format("[{:.17g}]", fmt::join(rows.data(), rows.data() + 16, ", "));
}

std::string camera_list(const Camera& camera) {
  return fmt::format("[{:.17g}, {:.17g}, {:.17g}, {:.17g}]", camera.fx, camera.fy, camera.cx, camera.cy);
}

const char* model_text(const Camera& camera) {
  return camera.model == CameraModel::kKannalaBrandt ? "kannala-brandt" : "radial-tangential";
}

/// Four coefficients, as in the data of EuRoC, unless others are not 0.
std::span<const double> euroc_coefficients(const Camera& camera) {
  const std::span<const double> all = camera.coefficients();
  return all.size() == 5 && all[4] == 0.0 ? all.first(4) : all;
}

std::string pose_text(const Pose& pose) {
  return fmt::format("{:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}", pose.p.x(), pose.p.y(), pose.p.z(),
                     pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w());
}

std::string imu_row(const ImuSample& sample, char separator) {
  return fmt::format("{0}{6}{1:.17g}{6}{2:.17g}{6}{3:.17g}{6}{4:.17g}{6}{5:.17g}", sample.gyro_b.x(),
                     sample.gyro_b.y(), sample.gyro_b.z(), sample.accel_b.x(), sample.accel_b.y(),
                     sample.accel_b.z(), separator);
}

void write_tum_images(const SensorStream& stream, const fs::path& folder, const ExportControl& control) {
  fs::create_directories(folder / "rgb");
  fs::create_directories(folder / "depth");
  std::string colors;
  std::string depths;
  for (std::size_t i = 0; i < stream.info().frame_times.size(); ++i) {
    const Frame frame = stream.load_frame(i);
    const std::string stamp = eval::format_stamp(frame.t);
    const cv::Mat color = color_image(frame);
    write_png(folder / "rgb" / (stamp + ".png"), color.empty() ? frame.gray : color);
    colors += fmt::format("{0} rgb/{0}.png\n", stamp);
    if (!frame.depth.empty()) {
      write_png(folder / "depth" / (stamp + ".png"), frame.depth);
      depths += fmt::format("{0} depth/{0}.png\n", stamp);
    }
    report_frame(control, i + 1, stream.info().frame_times.size());
  }
  eval::write_text_file(folder / "rgb.txt", colors);
  eval::write_text_file(folder / "depth.txt", depths);
}

void write_tum_texts(const SequenceInfo& info, const fs::path& folder) {
  eval::write_text_file(folder / "rig.toml", rig_file_text(info.rig));
  std::string poses = "# timestamp tx ty tz qx qy qz qw (camera in world)\n";
  const Pose T_f_c = info.ground_truth.T_c_f.inverse();
  for (const StampedPose& pose : info.ground_truth.trajectory.poses) {
    poses += eval::format_stamp(pose.t) + " " + pose_text(pose.T_w_f * T_f_c) + "\n";
  }
  if (!info.ground_truth.trajectory.poses.empty()) eval::write_text_file(folder / "groundtruth.txt", poses);
  if (info.imu.empty()) return;
  std::string samples = "# timestamp wx wy wz ax ay az\n";
  for (const ImuSample& sample : info.imu)
    samples += eval::format_stamp(sample.t) + " " + imu_row(sample, ' ') + "\n";
  eval::write_text_file(folder / "imu.txt", samples);
}

void write_euroc_images(const SensorStream& stream, const fs::path& folder, const ExportControl& control) {
  fs::create_directories(folder / "data");
  std::string list = "#timestamp [ns],filename\n";
  for (std::size_t i = 0; i < stream.info().frame_times.size(); ++i) {
    const Frame frame = stream.load_frame(i);
    write_png(folder / "data" / fmt::format("{}.png", frame.t.ns), frame.gray);
    list += fmt::format("{0},{0}.png\n", frame.t.ns);
    report_frame(control, i + 1, stream.info().frame_times.size());
  }
  eval::write_text_file(folder / "data.csv", list);
}

void write_euroc_sensors(const Rig& rig, const fs::path& mav) {
  const Camera& camera = rig.camera;
  eval::write_text_file(
      mav / "cam0" / "sensor.yaml",
      fmt::format("sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: {}\nresolution: [{}, {}]\n"
                  "camera_model: pinhole\nintrinsics: {}\ndistortion_model: {}\n"
                  "distortion_coefficients: [{:.17g}]\n",
                  matrix_text(rig.T_b_c), camera.width, camera.height, camera_list(camera),
                  model_text(camera), fmt::join(euroc_coefficients(camera), ", ")));
  eval::write_text_file(
      mav / "imu0" / "sensor.yaml",
      fmt::format(
          "sensor_type: imu\nT_BS:\n  cols: 4\n  rows: 4\n  data: {}\ngyroscope_noise_density: {:.17g}\n"
          "gyroscope_random_walk: {:.17g}\naccelerometer_noise_density: {:.17g}\n"
          "accelerometer_random_walk: {:.17g}\n",
          matrix_text(Pose{}), rig.imu_noise.gyro_noise, rig.imu_noise.gyro_walk, rig.imu_noise.accel_noise,
          rig.imu_noise.accel_walk));
}

void write_euroc_texts(const SequenceInfo& info, const fs::path& mav) {
  fs::create_directories(mav / "imu0");
  write_euroc_sensors(info.rig, mav);
  std::string samples = "#timestamp [ns],w_x,w_y,w_z [rad s^-1],a_x,a_y,a_z [m s^-2]\n";
  for (const ImuSample& sample : info.imu)
    samples += fmt::format("{},{}\n", sample.t.ns, imu_row(sample, ','));
  eval::write_text_file(mav / "imu0" / "data.csv", samples);
  if (info.ground_truth.trajectory.poses.empty()) return;
  const fs::path truth = mav / "state_groundtruth_estimate0";
  fs::create_directories(truth);
  const Pose T_f_b = info.ground_truth.T_c_f.inverse() * info.rig.T_b_c.inverse();
  std::string poses = "#timestamp,p_x,p_y,p_z,q_w,q_x,q_y,q_z,v_x,v_y,v_z,bw_x,bw_y,bw_z,ba_x,ba_y,ba_z\n";
  for (const StampedPose& pose : info.ground_truth.trajectory.poses) {
    const Pose T_w_b = pose.T_w_f * T_f_b;
    poses += fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},0,0,0,0,0,0,0,0,0\n", pose.t.ns,
                         T_w_b.p.x(), T_w_b.p.y(), T_w_b.p.z(), T_w_b.q.w(), T_w_b.q.x(), T_w_b.q.y(),
                         T_w_b.q.z());
  }
  eval::write_text_file(truth / "data.csv", poses);
  eval::write_text_file(truth / "sensor.yaml",
                        "T_BS:\n  cols: 4\n  rows: 4\n  data: " + matrix_text(Pose{}) + "\n");
}

}  // namespace

void export_tum(const SensorStream& stream, const fs::path& folder, const ExportControl& control) {
  write_atomically(folder, [&](const fs::path& unfinished) {
    write_tum_images(stream, unfinished, control);
    write_tum_texts(stream.info(), unfinished);
    write_boxes(stream.info(), unfinished);
  });
}

void export_euroc(const SensorStream& stream, const fs::path& folder, const ExportControl& control) {
  if (stream.info().imu.empty()) {
    throw InputError(stream.info().folder.string(),
                     "has no IMU, which the EuRoC layout requires; use layout = \"tum\"");
  }
  write_atomically(folder, [&](const fs::path& unfinished) {
    write_euroc_images(stream, unfinished / "mav0" / "cam0", control);
    write_boxes(stream.info(), unfinished);
    write_euroc_texts(stream.info(), unfinished / "mav0");
    // The files of EuRoC have no time offset and no readout time.
    eval::write_text_file(unfinished / "rig.toml", rig_file_text(stream.info().rig));
  });
}

namespace {

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
    const std::span<const double> coefficients =
        camera.coefficients().first(fisheye ? 4 : camera.coefficients().size());
    const CameraInfoMessage message{
        .header = {.stamp = t, .frame = kCameraFrame},
        .height = static_cast<std::uint32_t>(camera.height),
        .width = static_cast<std::uint32_t>(camera.width),
        .distortion_model = fisheye                    ? "equidistant"
                            : camera.has_denominator() ? "rational_polynomial"
                                                       : "plumb_bob",
        .D = std::vector<double>(coefficients.begin(), coefficients.end()),
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

/// The files beside a bag, and their texts; without a text there must be no file, as it would be read.
std::map<fs::path, std::string> companions_of(const SequenceInfo& info, const fs::path& path) {
  return {{companion_file(path, "rig.toml"), companion_rig(info.rig)},
          {companion_file(path, "detections.txt"),
           info.detections.empty() ? "" : detections_text(info.detections)}};
}

/// NAME.bag and NAME.mcap have the same files beside them.
/// @throws InputError if one exists with another text
void require_no_others(const std::map<fs::path, std::string>& companions) {
  std::error_code ignored;
  for (const auto& [file, text] : companions) {
    if (fs::exists(file, ignored) && eval::read_text_file(file) != text)
      throw InputError(file.string(), "exists, and belongs to another bag of this name; choose another name");
  }
}

}  // namespace

void export_bag(const SensorStream& stream, const fs::path& path, const std::string& compression,
                const ExportControl& control) {
  const std::optional<ChunkCompression> method = compression_of(compression);
  if (!method)
    throw InputError("compression \"" + compression + "\"", "is unknown; expected none, bz2, lz4 or zstd");
  std::error_code ignored;
  if (fs::exists(path, ignored)) throw InputError(path.string(), "exists; choose another name or remove it");
  require_no_others(companions_of(stream.info(), path));
  BagExporter(stream, path, *method).run(control);
  for (const auto& [file, text] : companions_of(stream.info(), path)) {  // a folder of rosbag2 contains them
    if (!text.empty()) eval::write_text_file(file, text);
  }
}

}  // namespace stillpoint::datasets
