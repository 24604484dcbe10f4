// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/rig_yaml_text.h"

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/calibration/rig_file.h"

namespace stillpoint::datasets {
namespace {

constexpr std::size_t kRadialTangentialCount = 4;  ///< k1 k2 p1 p2, which all formats have

bool is_fisheye(const Camera& camera) { return camera.model == CameraModel::kKannalaBrandt; }

std::string numbers(std::span<const double> values) {
  return fmt::format("[{:.17g}]", fmt::join(values, ", "));
}

/// The four coefficients of a format that has no more.
/// @throws InputError if the camera has others
std::span<const double> four_coefficients(const Camera& camera, std::string_view format) {
  const std::span<const double> all(camera.distortion);
  if (std::ranges::any_of(all.subspan(kRadialTangentialCount), [](double value) { return value != 0.0; }))
    throw InputError("--out-format " + std::string(format),
                     "has no distortion with more than four coefficients; use opencv or toml");
  return all.first(kRadialTangentialCount);
}

/// A 4x4 matrix as a list of rows.
std::string matrix_rows(const std::string& key, const Pose& pose) {
  const Eigen::Matrix4d matrix = pose.matrix();
  std::string text = key + ":\n";
  for (int row = 0; row < 4; ++row)
    text += fmt::format("    - [{:.17g}, {:.17g}, {:.17g}, {:.17g}]\n", matrix(row, 0), matrix(row, 1),
                        matrix(row, 2), matrix(row, 3));
  return text;
}

/// A matrix as OpenCV's FileStorage has it.
/// @param type of its elements: d (double) or f (float)
template <class Matrix>
std::string opencv_matrix(const std::string& key, const Matrix& matrix, char type = 'd') {
  std::vector<double> values;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) values.push_back(matrix(row, column));
  }
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: {}\n   data: {}\n", key,
                     matrix.rows(), matrix.cols(), type, numbers(values));
}

/// The values that a format does not have, as comments.
std::string comments(const std::vector<std::pair<std::string_view, double>>& values) {
  std::string text;
  for (const auto& [name, value] : values)
    text += fmt::format("# not in this format: {} = {:.17g}\n", name, value);
  return text;
}

/// A 3x3 matrix as a list of rows.
/// @param key with the blanks in front of it, at most four
std::string axes_matrix(const std::string& key, const Eigen::Matrix3d& matrix) {
  std::string text = key + ":\n";
  for (int row = 0; row < 3; ++row)
    text +=
        fmt::format("    - [{:.17g}, {:.17g}, {:.17g}]\n", matrix(row, 0), matrix(row, 1), matrix(row, 2));
  return text;
}

/// The model "scale-misalignment" of Kalibr, whose gyroscope may be turned in the IMU.
std::string kalibr_axes(const ImuAxes& axes) {
  if (axes == ImuAxes{}) return "";
  return "  model: scale-misalignment\n  accelerometers:\n" + axes_matrix("    M", axes.accel) +
         "  gyroscopes:\n" + axes_matrix("    M", axes.gyro) + axes_matrix("    A", Eigen::Matrix3d::Zero()) +
         axes_matrix("    C_gyro_i", Eigen::Matrix3d::Identity());
}

/// The model "kalibr" of OpenVINS, which requires all of these matrices.
std::string openvins_axes(const ImuAxes& axes) {
  return "  model: kalibr\n" + axes_matrix("  Tw", axes.gyro) +
         axes_matrix("  R_IMUtoGYRO", Eigen::Matrix3d::Identity()) + axes_matrix("  Ta", axes.accel) +
         axes_matrix("  R_IMUtoACC", Eigen::Matrix3d::Identity()) +
         axes_matrix("  Tg", Eigen::Matrix3d::Zero());
}

/// Axes as comments of the formats that do not have them.
std::string axes_comments(const ImuAxes& axes) {
  if (axes == ImuAxes{}) return "";
  std::string text;
  for (const auto& [key, matrix] : {std::pair("gyro_axes", axes.gyro), std::pair("accel_axes", axes.accel)}) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = matrix;
    text += fmt::format("# not in this format: {} = {}\n", key, numbers(std::span(rows.data(), 9)));
  }
  return text;
}

std::string kalibr_text(const Rig& rig, bool openvins) {
  const Camera& camera = rig.camera;
  std::string text =
      comments({{"depth_units_per_m", rig.depth_units_per_m}, {"rolling_shutter_s", rig.rolling_shutter_s}});
  text += "cam0:\n";
  if (rig.has_imu)
    text +=
        openvins ? matrix_rows("  T_imu_cam", rig.T_b_c) : matrix_rows("  T_cam_imu", rig.T_b_c.inverse());
  text += fmt::format(
      "  camera_model: pinhole\n  intrinsics: {}\n  distortion_model: {}\n  distortion_coeffs: {}\n"
      "  resolution: [{}, {}]\n",
      numbers(std::vector{camera.fx, camera.fy, camera.cx, camera.cy}),
      is_fisheye(camera) ? "equidistant" : "radtan",
      numbers(four_coefficients(camera, openvins ? "openvins" : "kalibr")), camera.width, camera.height);
  if (!rig.has_imu) return text;
  return text +
         fmt::format(
             "  timeshift_cam_imu: {:.17g}\nimu0:\n  gyroscope_noise_density: {:.17g}\n"
             "  gyroscope_random_walk: {:.17g}\n  accelerometer_noise_density: {:.17g}\n"
             "  accelerometer_random_walk: {:.17g}\n",
             rig.time_offset_s, rig.imu_noise.gyro_noise, rig.imu_noise.gyro_walk, rig.imu_noise.accel_noise,
             rig.imu_noise.accel_walk) +
         (openvins ? openvins_axes(rig.imu_axes) : kalibr_axes(rig.imu_axes));
}

std::string opencv_text(const Rig& rig) {
  const Camera& camera = rig.camera;
  const std::span<const double> used =
      is_fisheye(camera) ? four_coefficients(camera, "opencv") : camera.coefficients();
  const Eigen::Matrix3d K{{camera.fx, 0.0, camera.cx}, {0.0, camera.fy, camera.cy}, {0.0, 0.0, 1.0}};
  return fmt::format("image_width: {}\nimage_height: {}\n", camera.width, camera.height) +
         opencv_matrix("camera_matrix", K) +
         opencv_matrix("distortion_coefficients", Eigen::Map<const Eigen::VectorXd>(
                                                      used.data(), static_cast<Eigen::Index>(used.size()))) +
         fmt::format("fisheye_model: {}\n", is_fisheye(camera) ? 1 : 0) +
         comments(
             {{"depth_units_per_m", rig.depth_units_per_m}, {"rolling_shutter_s", rig.rolling_shutter_s}}) +
         (rig.has_imu ? "# not in this format: the IMU\n" : "");
}

/// Its reader requires real numbers with a decimal point, and a matrix of floats.
std::string orb_slam_text(const Rig& rig) {
  const Camera& camera = rig.camera;
  if (!is_fisheye(camera) && camera.has_denominator())
    throw InputError("--out-format orb_slam", "has no k4 to k6; use opencv or toml");
  std::string text = fmt::format(
      "File.version: \"1.0\"\n# not in a calibration, but required: Camera.fps, Camera.RGB, IMU.Frequency\n"
      "Camera.type: \"{}\"\nCamera.width: {}\nCamera.height: {}\nCamera1.fx: {:#.17g}\nCamera1.fy: {:#.17g}\n"
      "Camera1.cx: {:#.17g}\nCamera1.cy: {:#.17g}\n",
      is_fisheye(camera) ? "KannalaBrandt8" : "PinHole", camera.width, camera.height, camera.fx, camera.fy,
      camera.cx, camera.cy);
  const std::vector<std::string_view> names =
      is_fisheye(camera) ? std::vector<std::string_view>{"k1", "k2", "k3", "k4"}
                         : std::vector<std::string_view>{"k1", "k2", "p1", "p2", "k3"};
  for (std::size_t i = 0; i < names.size(); ++i)
    text += fmt::format("Camera1.{}: {:#.17g}\n", names[i], camera.distortion[i]);
  text += fmt::format("RGBD.DepthMapFactor: {:#.17g}\n", rig.depth_units_per_m) +
          comments({{"rolling_shutter_s", rig.rolling_shutter_s}, {"time_offset_s", rig.time_offset_s}});
  if (!rig.has_imu) return text;
  const ImuNoise& noise = rig.imu_noise;
  return text + opencv_matrix("IMU.T_b_c1", rig.T_b_c.matrix(), 'f') +
         fmt::format(
             "IMU.NoiseGyro: {:#.17g}\nIMU.NoiseAcc: {:#.17g}\nIMU.GyroWalk: {:#.17g}\nIMU.AccWalk: "
             "{:#.17g}\n",
             noise.gyro_noise, noise.accel_noise, noise.gyro_walk, noise.accel_walk);
}

std::string vins_text(const Rig& rig) {
  const Camera& camera = rig.camera;
  const std::span<const double> k = four_coefficients(camera, "vins");
  std::string text = fmt::format("image_width: {}\nimage_height: {}\n", camera.width, camera.height);
  if (is_fisheye(camera)) {
    text += fmt::format(
        "model_type: KANNALA_BRANDT\nprojection_parameters:\n   k2: {:.17g}\n   k3: {:.17g}\n   k4: {:.17g}\n"
        "   k5: {:.17g}\n   mu: {:.17g}\n   mv: {:.17g}\n   u0: {:.17g}\n   v0: {:.17g}\n",
        k[0], k[1], k[2], k[3], camera.fx, camera.fy, camera.cx, camera.cy);
  } else {
    text += fmt::format(
        "model_type: PINHOLE\ndistortion_parameters:\n   k1: {:.17g}\n   k2: {:.17g}\n   p1: {:.17g}\n"
        "   p2: {:.17g}\nprojection_parameters:\n   fx: {:.17g}\n   fy: {:.17g}\n   cx: {:.17g}\n   cy: "
        "{:.17g}\n",
        k[0], k[1], k[2], k[3], camera.fx, camera.fy, camera.cx, camera.cy);
  }
  if (rig.rolling_shutter_s > 0.0)
    text += fmt::format("rolling_shutter: 1\nrolling_shutter_tr: {:.17g}\n", rig.rolling_shutter_s);
  text += comments({{"depth_units_per_m", rig.depth_units_per_m}});
  if (!rig.has_imu) return text;
  const ImuNoise& noise = rig.imu_noise;
  return text + fmt::format("td: {:.17g}\n", rig.time_offset_s) +
         opencv_matrix("body_T_cam0", rig.T_b_c.matrix()) +
         opencv_matrix("extrinsicRotation", rig.T_b_c.R()) +
         opencv_matrix("extrinsicTranslation", rig.T_b_c.p) +
         "# acc_n, gyr_n, acc_w and gyr_w are noises of a sample, by the rate of the IMU from these "
         "densities:\n" +
         comments({{"gyro_noise", noise.gyro_noise},
                   {"accel_noise", noise.accel_noise},
                   {"gyro_walk", noise.gyro_walk},
                   {"accel_walk", noise.accel_walk}});
}

}  // namespace

std::string rig_text(const Rig& rig, RigFormat format) {
  constexpr std::string_view kYaml = "%YAML:1.0\n---\n";  // what OpenCV's FileStorage requires
  const std::string head(kYaml);
  switch (format) {
    case RigFormat::kStillpoint:
      return rig_file_text(rig);
    case RigFormat::kKalibr:
      return kalibr_text(rig, false);
    case RigFormat::kOpenvins:
      return head + kalibr_text(rig, true);
    case RigFormat::kOpencv:
      return head + opencv_text(rig) + axes_comments(rig.imu_axes);
    case RigFormat::kOrbSlam:
      return head + orb_slam_text(rig) + axes_comments(rig.imu_axes);
    case RigFormat::kVins:
      return head + vins_text(rig) + axes_comments(rig.imu_axes);
  }
  STILLPOINT_CHECK(false && "a format without writer");
  return {};
}

}  // namespace stillpoint::datasets
