// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sequence_export.h"

#include <unistd.h>

#include <functional>

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/calibration/rig_file.h"
#include "datasets/io/detections_file.h"
#include "datasets/io/image_io.h"
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
                  model_text(camera),
                  fmt::join(camera.distortion.begin(), camera.distortion.begin() + 4, ", ")));
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
  });
}

}  // namespace stillpoint::datasets
