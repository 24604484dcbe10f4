// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/sequences/sequence_folders.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "datasets/io/image_io.h"

namespace stillpoint {
namespace {

constexpr int kFrames = 3;

void write_color(const std::filesystem::path& file, int width, int height) {
  std::filesystem::create_directories(file.parent_path());
  datasets::write_png(file, cv::Mat(height, width, CV_8UC3, cv::Scalar(255, 0, 0)));
}

void write_depth(const std::filesystem::path& file, int width, int height, int value) {
  std::filesystem::create_directories(file.parent_path());
  datasets::write_png(file, cv::Mat(height, width, CV_16UC1, cv::Scalar(value)));
}

/// Rows `t x 0 0 0 0 0 1` every 10 ms from `start` over 0.3 s, x growing at 1 m/s.
std::string truth_rows(double start) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (int i = 0; i <= 30; ++i)
    text += fmt::format("{:.2f} {:.2f} 0 0 0 0 0 1\n", start + 0.01 * i, 0.01 * i);
  return text;
}

/// Rows `t value value value` at `rate_hz` from `start` over 0.3 s; the value is the time since the start.
std::string sensor_rows(double start, double rate_hz) {
  std::string text = "#Time x y z\n";
  for (int i = 0; i <= static_cast<int>(0.3 * rate_hz); ++i) {
    text += fmt::format("{0:.6f} {1:.6f} {1:.6f} {1:.6f}\n", start + i / rate_hz, i / rate_hz);
  }
  return text;
}

std::string sensor_block(const std::string& name, double noise, double walk) {
  return fmt::format("{}:\n  noise_variances:\n    data: [{}]\n  bias_variances:\n    data: [{}]\n", name,
                     noise, walk);
}

std::string link(const std::string& parent, const std::string& child, const std::string& data) {
  return fmt::format(
      "  - parent_frame: {}\n    child_frame: {}\n    matrix: !!opencv-matrix\n      rows: 4\n      cols: 4\n"
      "      dt: d\n      data: [{}]\n",
      parent, child, data);
}

}  // namespace

void write_tum_folder(const TemporaryFolder& folder) { write_tum_folder(folder, 8, 6); }

void write_tum_folder(const TemporaryFolder& folder, int depth_width, int depth_height) {
  std::string color = "# color images\n";
  std::string depth = "# depth maps\n";
  for (int i = 0; i < kFrames; ++i) {
    const std::string color_stamp = fmt::format("{:.6f}", 1.0 + 0.04 * i);
    const std::string depth_stamp = fmt::format("{:.6f}", 1.005 + 0.04 * i);
    color += fmt::format("{0} rgb/{0}.png\n", color_stamp);
    depth += fmt::format("{0} depth/{0}.png\n", depth_stamp);
    write_color(folder.path() / "rgb" / (color_stamp + ".png"), 8, 6);
    write_depth(folder.path() / "depth" / (depth_stamp + ".png"), depth_width, depth_height, 5000);
  }
  folder.write("rgb.txt", color);
  folder.write("depth.txt", depth);
  folder.write("groundtruth.txt", truth_rows(0.9));
  folder.write("rig.toml", "[camera]\nwidth = 8\nheight = 6\nfx = 10\nfy = 10\ncx = 3.5\ncy = 2.5\n");
}

void write_openloris_folder(const TemporaryFolder& folder) {
  std::string color;
  std::string depth;
  for (int i = 0; i < kFrames; ++i) {
    const std::string stamp = fmt::format("{:.6f}", 100.0 + 0.04 * i);
    color += fmt::format("{0} color/{0}.png\n", stamp);
    depth += fmt::format("{0} aligned_depth/{0}.png\n", stamp);
    write_color(folder.path() / "color" / (stamp + ".png"), 8, 6);
    write_depth(folder.path() / "aligned_depth" / (stamp + ".png"), 8, 6, 1000);
  }
  folder.write("color.txt", color);
  folder.write("aligned_depth.txt", depth);
  folder.write("groundtruth.txt", truth_rows(99.9));
  folder.write("d400_gyroscope.txt", sensor_rows(99.9, 400.0));
  folder.write("d400_accelerometer.txt", sensor_rows(99.9, 250.0));
  folder.write("sensors.yaml",
               "%YAML:1.0\nd400_color_optical_frame:\n  width: 8\n  height: 6\n  fps: 30\n"
               "  distortion_model: radial-tangential\n  distortion_coefficients: !!opencv-matrix\n"
               "    data: [0.1, 0, 0, 0, 0]\n  intrinsics:\n    data: [10, 3.5, 11, 2.5]\n" +
                   sensor_block("d400_gyroscope", 4e-6, 1e-10) +
                   sensor_block("d400_accelerometer", 9e-4, 4e-8));
  // Gyroscope and accelerometer are 0.1 m right of the camera, the camera is 1 m above base_link (y points
  // down).
  folder.write(
      "trans_matrix.yaml",
      "%YAML:1.0\ntrans_matrix:\n" +
          link("d400_color_optical_frame", "d400_gyroscope", "1,0,0,0.1, 0,1,0,0, 0,0,1,0, 0,0,0,1") +
          link("d400_gyroscope", "d400_accelerometer", "1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1") +
          link("base_link", "d400_color_optical_frame", "1,0,0,0, 0,1,0,-1, 0,0,1,0, 0,0,0,1"));
}

void write_euroc_folder(const TemporaryFolder& folder) {
  std::string images = "#timestamp [ns],filename\n";
  for (int i = 0; i < kFrames; ++i) {
    const long stamp = 1'000'000'000 + 50'000'000L * i;
    images += fmt::format("{0},{0}.png\r\n", stamp);
    const std::filesystem::path file = folder.path() / "mav0/cam0/data" / fmt::format("{}.png", stamp);
    std::filesystem::create_directories(file.parent_path());
    datasets::write_png(file, cv::Mat(6, 8, CV_8UC1, cv::Scalar(7)));
  }
  std::string imu = "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n";
  std::string truth = "#timestamp, p_x, p_y, p_z, q_w, q_x, q_y, q_z, v_x, v_y, v_z, b...\n";
  for (int i = 0; i <= 40; ++i) {
    const long stamp = 950'000'000 + 5'000'000L * i;
    imu += fmt::format("{},0.1,0.2,0.3,1,2,9.8\n", stamp);
    truth += fmt::format("{},{},0,0,0,1,0,0,0,0,0,0,0,0,0,0,0\n", stamp, 0.01 * i);
  }
  folder.write("mav0/cam0/data.csv", images);
  folder.write("mav0/imu0/data.csv", imu);
  folder.write("mav0/state_groundtruth_estimate0/data.csv", truth);
  const std::string identity = "T_BS:\n  cols: 4\n  rows: 4\n  data: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n";
  folder.write("mav0/state_groundtruth_estimate0/sensor.yaml", "%YAML:1.0\n" + identity);
  folder.write("mav0/imu0/sensor.yaml",
               "%YAML:1.0\n" + identity +
                   "gyroscope_noise_density: 1e-4\ngyroscope_random_walk: 2e-5\n"
                   "accelerometer_noise_density: 3e-3\naccelerometer_random_walk: 4e-3\n");
  folder.write("mav0/cam0/sensor.yaml",
               "%YAML:1.0\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1,0,0,0.5, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n"
               "resolution: [8, 6]\nintrinsics: [10, 11, 3.5, 2.5] #fu, fv, cu, cv\n"
               "distortion_model: radial-tangential\ndistortion_coefficients: [-0.2, 0.1, 0, 0]\n");
}

void write_seven_scenes_folder(const TemporaryFolder& folder) {
  for (int i = 0; i < kFrames; ++i) {
    const std::string stem = fmt::format("frame-{:06}", i);
    write_color(folder.path() / (stem + ".color.png"), 640, 480);
    write_depth(folder.path() / (stem + ".depth.png"), 640, 480, 1000);
    folder.write(stem + ".pose.txt", fmt::format("1 0 0 {}\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", 0.01 * i));
  }
}

void write_plain_folder(const TemporaryFolder& folder) {
  for (int i = 7; i < 7 + kFrames; ++i) {
    write_color(folder.path() / "color" / fmt::format("{:05}.png", i), 8, 6);
    write_depth(folder.path() / "depth" / fmt::format("{:05}.png", i), 8, 6, 1000);
  }
  folder.write("camera.json",
               R"({"width": 8, "height": 6, "intrinsic_matrix": [10, 0, 0, 0, 11, 0, 3.5, 2.5, 1]})");
}

}  // namespace stillpoint
