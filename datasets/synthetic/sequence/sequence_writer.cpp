// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/sequence_writer.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/io/detections_file.h"
#include "datasets/io/image_io.h"
#include "eval/io/text_reader.h"

namespace stillpoint::synth {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCameraFrame = "d400_color_optical_frame";

std::string exact_stamp(Timestamp t) { return fmt::format("{}.{:09}", t.ns / 1000000000, t.ns % 1000000000); }

const char* color_folder(SequenceLayout layout) { return layout == SequenceLayout::kTum ? "rgb" : "color"; }
const char* depth_folder(SequenceLayout layout) {
  return layout == SequenceLayout::kTum ? "depth" : "aligned_depth";
}

std::string image_list(const char* folder, const std::vector<Timestamp>& frames) {
  std::string text;
  for (const Timestamp t : frames) text += fmt::format("{0} {1}/{0}.png\n", image_stamp(t), folder);
  return text;
}

std::string camera_yaml(const char* name, const Camera& camera, double frames_per_s) {
  return fmt::format(
      "{}:\n  width: {}\n  height: {}\n  fps: {}\n  distortion_model: radial-tangential\n"
      "  distortion_coefficients:\n    data: [{}]\n  intrinsics:\n    data: [{}, {}, {}, {}]\n",
      name, camera.width, camera.height, frames_per_s, fmt::join(camera.coefficients(), ", "), camera.fx,
      camera.cx, camera.fy, camera.cy);
}

std::string imu_yaml(const char* name, double rate_hz, double density, double walk) {
  return fmt::format(
      "{0}:\n  fps: {1}\n  imu_intrinsic:\n    data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]\n"
      "  noise_variances:\n    data: [{2}, {2}, {2}]\n  bias_variances:\n    data: [{3}, {3}, {3}]\n",
      name, rate_hz, density * density, walk * walk);
}

std::string matrix_text(const Pose& pose) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = pose.matrix();
  return fmt::format("{:.12g}", fmt::join(rows.data(), rows.data() + 16, ", "));
}

std::string transform_yaml(const char* child, const Pose& T_parent_child) {
  return fmt::format(
      "  - parent_frame: {}\n    child_frame: {}\n    matrix:\n      rows: 4\n      cols: 4\n      data: "
      "[{}]\n",
      kCameraFrame, child, matrix_text(T_parent_child));
}

std::string axis_text(const std::string& header, const std::vector<datasets::VectorSample>& samples) {
  std::string text = header;
  for (const datasets::VectorSample& sample : samples) {
    text += fmt::format("{} {:.9f} {:.9f} {:.9f}\n", exact_stamp(sample.t), sample.value.x(),
                        sample.value.y(), sample.value.z());
  }
  return text;
}

}  // namespace

std::string image_stamp(Timestamp t) {
  const std::int64_t us = t.ns / 1000;
  return fmt::format("{}.{:06}", us / 1000000, us % 1000000);
}

SequenceWriter::SequenceWriter(const fs::path& folder, SequenceLayout layout, bool labels)
    : folder_(folder), layout_(layout) {
  std::vector<fs::path> needed{folder / color_folder(layout), folder / depth_folder(layout)};
  if (labels) needed.insert(needed.end(), {folder / "labels", folder / "motion"});
  for (const fs::path& path : needed) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error)
      throw InputError(path.string(), "cannot be created (" + error.message() + "); choose another folder");
  }
}

void SequenceWriter::write_text(const std::string& name, const std::string& text) const {
  eval::write_text_file(folder_ / name, text);
}

void SequenceWriter::write_images(const ImageStamps& stamps, const cv::Mat& color,
                                  const cv::Mat& depth) const {
  datasets::write_png(folder_ / color_folder(layout_) / (image_stamp(stamps.color) + ".png"), color);
  datasets::write_png(folder_ / depth_folder(layout_) / (image_stamp(stamps.depth) + ".png"), depth);
}

void SequenceWriter::write_labels(Timestamp t, const cv::Mat& labels, const cv::Mat& motion) const {
  const std::string name = image_stamp(t) + ".png";
  datasets::write_png(folder_ / "labels" / name, labels);
  datasets::write_png(folder_ / "motion" / name, motion);
}

void SequenceWriter::write_lists(const FrameTimes& frames) const {
  const bool tum = layout_ == SequenceLayout::kTum;
  write_text(tum ? "rgb.txt" : "color.txt", image_list(color_folder(layout_), frames.color));
  write_text(tum ? "depth.txt" : "aligned_depth.txt", image_list(depth_folder(layout_), frames.depth));
}

void SequenceWriter::write_rig(const Rig& rig, const SynthRequest& request) const {
  const Camera& camera = rig.camera;
  const ImuNoise& noise = rig.imu_noise;
  if (layout_ == SequenceLayout::kTum) {
    write_text(
        "rig.toml",
        fmt::format("[camera]\nwidth = {}\nheight = {}\nfx = {:.9f}\nfy = {:.9f}\ncx = {:.9f}\ncy = {:.9f}\n"
                    "model = \"radial-tangential\"\ndistortion = [{:#}]\n\n"
                    "[depth]\nscale = {:#}\n",
                    camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy,
                    fmt::join(camera.coefficients(), ", "), rig.depth_units_per_m));
    return;
  }
  write_text(
      "sensors.yaml",
      camera_yaml(kCameraFrame, camera, request.frames_per_s) +
          camera_yaml("d400_aligned_depth_optical_frame", camera, request.frames_per_s) +
          imu_yaml("d400_accelerometer", request.imu.accel_rate_hz, noise.accel_noise, noise.accel_walk) +
          imu_yaml("d400_gyroscope", request.imu.gyro_rate_hz, noise.gyro_noise, noise.gyro_walk));
  const Pose T_c_b = rig.T_b_c.inverse();
  write_text("trans_matrix.yaml", "trans_matrix:\n" + transform_yaml("d400_accelerometer", T_c_b) +
                                      transform_yaml("d400_gyroscope", T_c_b) +
                                      transform_yaml("base_link", Pose{}));
}

void SequenceWriter::write_imu(const ImuRecord& record) const {
  if (layout_ == SequenceLayout::kTum) return;  // a TUM folder has no gyroscope
  write_text("d400_gyroscope.txt", axis_text("#Time Gx Gy Gz\n", record.gyro));
  write_text("d400_accelerometer.txt", axis_text("#Time Ax Ay Az\n", record.accel));
}

void SequenceWriter::write_ground_truth(const Trajectory& camera_path) const {
  std::string text = "# timestamp tx ty tz qx qy qz qw (camera in world)\n";
  for (const StampedPose& pose : camera_path.poses) {
    const Eigen::Vector3d& p = pose.T_w_f.p;
    const Eigen::Quaterniond& q = pose.T_w_f.q;
    text += fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", exact_stamp(pose.t), p.x(),
                        p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  }
  write_text("groundtruth.txt", text);
}

void SequenceWriter::write_request(const SynthRequest& request) const {
  write_text("request.toml", request_text(request));
}

void SequenceWriter::write_boxes(const std::string& file, const std::vector<DetectionSet>& sets) const {
  write_text(file, datasets::detections_text(sets));
}

}  // namespace stillpoint::synth
