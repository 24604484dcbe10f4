// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/rig_yaml.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/base/error.h"
#include "datasets/io/lens_model.h"
#include "datasets/io/sensor_yaml.h"
#include "eval/io/matrix_files.h"

namespace stillpoint::datasets {
namespace {

constexpr double kMaxDifference = 1e-3;  ///< [m, rad] between two statements of one transform, as written

/// The first of the keys that the file has: spellings of one value.
std::optional<std::string> key_of(const SensorYaml& yaml, std::initializer_list<const char*> spellings) {
  for (const char* const key : spellings) {
    if (yaml.has(key)) return key;
  }
  return std::nullopt;
}

/// What a file contains, and which parts of it were read.
class YamlRig {
 public:
  YamlRig(std::filesystem::path file, const Rig& rig) : file_(std::move(file)) { result_.rig = rig; }

  void read() { read_file(file_, 0); }

  [[nodiscard]] OverriddenRig result() && {
    if (result_.notes.empty())
      throw InputError(
          file_.string(),
          "is YAML without a calibration that is known; expected cam0 or imu0 (Kalibr), "
          "camera_matrix (OpenCV, ROS), Camera.fx (ORB-SLAM), projection_parameters (VINS), or a "
          "rig.toml: camera = { width = 640, height = 480, fx = 535.4, fy = 539.2, cx = 320.1, "
          "cy = 247.6 }");
    const Camera& camera = result_.rig.camera;
    if (camera.fx > 0.0 && camera.width <= 0)
      throw InputError(file_.string(),
                       "the size of the images is missing; add image_width and image_height in pixels");
    return std::move(result_);
  }

 private:
  void read_file(const std::filesystem::path& file, int depth) {
    const SensorYaml yaml(file);
    read_kalibr(yaml);
    read_opencv(yaml);
    read_orb_slam(yaml);
    read_vins(yaml);
    for (const char* const key : {"cam0_calib", "relative_config_imu", "relative_config_imucam"}) {
      if (!yaml.has(key)) continue;
      if (depth > 0) yaml.fail(key, "names a further file; a calibration may be divided once");
      read_file(file.parent_path() / yaml.text(key), depth + 1);
    }
  }

  void read_kalibr(const SensorYaml& yaml);
  void read_opencv(const SensorYaml& yaml);
  void read_orb_slam(const SensorYaml& yaml);
  void read_vins(const SensorYaml& yaml);
  void read_kalibr_camera(const SensorYaml& camera);
  void read_kalibr_axes(const SensorYaml& imu);
  void read_size(const SensorYaml& yaml, Camera& camera) const;

  void note(const std::string& text) { result_.notes.push_back(text); }

  /// @param T_b_c camera to IMU; must agree with what the file stated before
  void set_extrinsic(const SensorYaml& yaml, const std::string& key, const Pose& T_b_c) {
    const Pose difference = result_.rig.T_b_c.inverse() * T_b_c;
    if (result_.has_extrinsic &&
        (difference.p.norm() > kMaxDifference || Eigen::AngleAxisd(difference.q).angle() > kMaxDifference))
      yaml.fail(key, "contradicts another transform between camera and IMU in this file; remove one");
    result_.rig.T_b_c = T_b_c;
    result_.has_extrinsic = true;
    note(key);
  }

  std::filesystem::path file_;
  OverriddenRig result_;
};

void YamlRig::read_kalibr_camera(const SensorYaml& camera) {
  result_.rig.camera = camera.camera();
  note("camera");
  if (camera.has("T_cam_imu")) set_extrinsic(camera, "T_cam_imu", camera.pose("T_cam_imu").inverse());
  for (const char* const key : {"T_imu_cam", "T_BS"}) {
    if (camera.has(key)) set_extrinsic(camera, key, camera.pose(key));
  }
  if (!camera.has("timeshift_cam_imu")) return;
  result_.rig.time_offset_s = camera.number("timeshift_cam_imu");
  note("timeshift_cam_imu");
}

void YamlRig::read_kalibr(const SensorYaml& yaml) {
  if (yaml.has("cam0")) {
    read_kalibr_camera(yaml.child("cam0"));
    if (yaml.has("cam1")) note("of several cameras, the first one (cam0) is that of the color images");
  } else if (yaml.has("cam1")) {
    yaml.fail("cam0", "is missing; the calibration of the color camera must be named cam0");
  } else if (yaml.has("intrinsics") && yaml.has("distortion_model")) {
    read_kalibr_camera(yaml);
  }
  const bool nested = yaml.has("imu0") && yaml.child("imu0").has("gyroscope_noise_density");
  if (!nested && !yaml.has("gyroscope_noise_density")) return;
  const SensorYaml imu = nested ? yaml.child("imu0") : yaml;
  result_.rig.imu_noise = imu.imu_noise();
  note("noise densities");
  read_kalibr_axes(imu);
}

/// Kalibr: measured acceleration M a + bias, measured rate M C_gyro_i w + A a + bias.
/// OpenVINS: Ta R_IMUtoACC a + bias, and Tw R_IMUtoGYRO w + Tg a + bias.
void YamlRig::read_kalibr_axes(const SensorYaml& imu) {
  const auto matrix = [](const SensorYaml& sensor, const std::string& key) -> Eigen::Matrix3d {
    const std::vector<double> values = sensor.numbers(key);
    if (values.size() != 9) sensor.fail(key, "must have 9 numbers (3x3)");
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
  };
  const auto axes_of = [&](const SensorYaml& sensor, const std::string& key, const std::string& rotation) {
    Eigen::Matrix3d axes = matrix(sensor, key);
    if (sensor.has(rotation)) axes = axes * matrix(sensor, rotation);
    if (!are_plausible_axes(axes))
      sensor.fail(key, "is not within 0.2 of the identity matrix: turned axes are not supported");
    return axes;
  };
  const auto note_influence = [&](const SensorYaml& sensor, const std::string& key) {
    if (sensor.has(key) && !matrix(sensor, key).isZero(0.0))
      note("the influence " + key + " of accelerations on the gyroscope is not read");
  };
  ImuAxes& result = result_.rig.imu_axes;
  if (imu.has("accelerometers") && imu.child("accelerometers").has("M")) {
    result.accel = axes_of(imu.child("accelerometers"), "M", "");
    note("axes of the accelerometer");
  } else if (imu.has("Ta")) {
    result.accel = axes_of(imu, "Ta", "R_IMUtoACC");
    note("axes of the accelerometer");
  }
  if (imu.has("gyroscopes") && imu.child("gyroscopes").has("M")) {
    result.gyro = axes_of(imu.child("gyroscopes"), "M", "C_gyro_i");
    note("axes of the gyroscope");
    note_influence(imu.child("gyroscopes"), "A");
  } else if (imu.has("Tw")) {
    result.gyro = axes_of(imu, "Tw", "R_IMUtoGYRO");
    note("axes of the gyroscope");
    note_influence(imu, "Tg");
  }
}

/// Spellings of OpenCV: with or without underscores, in several versions of its calibration program.
void YamlRig::read_size(const SensorYaml& yaml, Camera& camera) const {
  const auto size = [&yaml](std::initializer_list<const char*> spellings, int known) {
    const std::optional<std::string> key = key_of(yaml, spellings);
    return key ? yaml.positive_int(*key) : known;
  };
  camera.width =
      size({"image_width", "image_Width", "imageWidth", "Camera.width", "Camera.w", "width"}, camera.width);
  camera.height = size({"image_height", "image_Height", "imageHeight", "Camera.height", "Camera.h", "height"},
                       camera.height);
  const std::optional<std::string> both = key_of(yaml, {"cameraResolution", "image_size"});
  if (!both) return;
  const std::vector<double> values = yaml.numbers(*both);
  if (values.size() != 2 || values[0] < 1.0 || values[1] < 1.0) yaml.fail(*both, "must be width and height");
  camera.width = static_cast<int>(values[0]);
  camera.height = static_cast<int>(values[1]);
}

void YamlRig::read_opencv(const SensorYaml& yaml) {
  const std::optional<std::string> matrix =
      key_of(yaml, {"camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "k"});
  if (!matrix) return;
  const std::vector<double> K = yaml.numbers(*matrix);
  if (K.size() != 9 || K[0] <= 0.0 || K[4] <= 0.0)
    yaml.fail(*matrix, "must be a 3x3 matrix: fx 0 cx 0 fy cy 0 0 1");
  if (K[1] != 0.0 || K[3] != 0.0 || K[6] != 0.0 || K[7] != 0.0 || K[8] != 1.0)
    yaml.fail(*matrix, "must have the form fx 0 cx 0 fy cy 0 0 1, without skew");
  Camera camera = result_.rig.camera;
  camera.fx = K[0];
  camera.fy = K[4];
  camera.cx = K[2];
  camera.cy = K[5];
  read_size(yaml, camera);
  const std::optional<std::string> coefficients =
      key_of(yaml, {"distortion_coefficients", "distortionCoefficients", "Distortion_Coefficients",
                    "dist_coeffs", "D", "d"});
  NamedLens lens;
  if (coefficients) lens.coefficients = yaml.numbers(*coefficients);
  if (yaml.has("distortion_model")) {
    lens.name = yaml.text("distortion_model");
  } else if (yaml.has("fisheye_model") && yaml.number("fisheye_model") != 0.0) {
    lens.name = "fisheye";
  }
  result_.rig.camera = with_lens(camera, lens, file_.string());
  note("camera");
}

void YamlRig::read_orb_slam(const SensorYaml& yaml) {
  const std::string name = yaml.has("Camera1.fx") ? "Camera1." : "Camera.";
  if (yaml.has(name + "fx")) {
    Camera camera = result_.rig.camera;
    camera.fx = yaml.positive(name + "fx");
    camera.fy = yaml.positive(name + "fy");
    camera.cx = yaml.number(name + "cx");
    camera.cy = yaml.number(name + "cy");
    read_size(yaml, camera);
    const std::string type = yaml.has("Camera.type") ? yaml.text("Camera.type") : "PinHole";
    const bool fisheye = type == "KannalaBrandt8";
    if (!fisheye && type != "PinHole" && type != "Rectified")
      yaml.fail("Camera.type", "is \"" + type + "\"; supported are PinHole, Rectified and KannalaBrandt8");
    NamedLens lens{.name = fisheye ? "fisheye" : "pinhole", .coefficients = {}};
    const std::vector<std::string> keys =
        fisheye ? std::vector<std::string>{"k1", "k2", "k3", "k4"}
                : std::vector<std::string>{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
    for (const std::string& key : keys)
      lens.coefficients.push_back(yaml.has(name + key) ? yaml.number(name + key) : 0.0);
    result_.rig.camera = with_lens(camera, lens, file_.string());
    note("camera");
  }
  if (const std::optional<std::string> key = key_of(yaml, {"IMU.T_b_c1", "Tbc"}))
    set_extrinsic(yaml, *key, yaml.pose(*key));
  ImuNoise& noise = result_.rig.imu_noise;
  for (const auto& [key, value] : {std::pair("IMU.NoiseGyro", &noise.gyro_noise),
                                   {"IMU.NoiseAcc", &noise.accel_noise},
                                   {"IMU.GyroWalk", &noise.gyro_walk},
                                   {"IMU.AccWalk", &noise.accel_walk}}) {
    if (!yaml.has(key)) continue;
    *value = yaml.positive(key);
    note(key);
  }
  const std::optional<std::string> scale = key_of(yaml, {"RGBD.DepthMapFactor", "DepthMapFactor"});
  if (!scale) return;
  const double units_per_m = yaml.positive(*scale);
  if (units_per_m == 1.0) return;  // depth in meters, of which the unit of the files is known
  result_.rig.depth_units_per_m = units_per_m;
  note(*scale);
}

/// [R t; 0 1]
std::optional<Pose> pose_of(const std::vector<double>& R, const std::vector<double>& t) {
  if (R.size() != 9 || t.size() != 3) return std::nullopt;
  std::array<double, 16> matrix{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) matrix[4 * row + column] = R[3 * row + column];
    matrix[4 * row + 3] = t[row];
  }
  matrix[15] = 1.0;
  return eval::rigid_pose(matrix);
}

void YamlRig::read_vins(const SensorYaml& yaml) {
  if (yaml.has("projection_parameters")) {
    const std::string model = yaml.has("model_type") ? yaml.text("model_type") : "PINHOLE";
    const bool fisheye = model == "KANNALA_BRANDT";
    if (!fisheye && model != "PINHOLE")
      yaml.fail("model_type", "is \"" + model + "\"; supported are PINHOLE and KANNALA_BRANDT");
    const SensorYaml projection = yaml.child("projection_parameters");
    const SensorYaml distortion = fisheye ? projection : yaml.child("distortion_parameters");
    Camera camera = result_.rig.camera;
    camera.fx = projection.positive(fisheye ? "mu" : "fx");
    camera.fy = projection.positive(fisheye ? "mv" : "fy");
    camera.cx = projection.number(fisheye ? "u0" : "cx");
    camera.cy = projection.number(fisheye ? "v0" : "cy");
    read_size(yaml, camera);
    NamedLens lens{.name = fisheye ? "fisheye" : "pinhole", .coefficients = {}};
    for (const char* const key :
         fisheye ? std::array{"k2", "k3", "k4", "k5"} : std::array{"k1", "k2", "p1", "p2"})
      lens.coefficients.push_back(distortion.number(key));
    result_.rig.camera = with_lens(camera, lens, file_.string());
    note("camera");
  }
  if (yaml.has("estimate_extrinsic") && yaml.number("estimate_extrinsic") == 2.0) {
    note("estimate_extrinsic is 2: the transform between camera and IMU is not read");
  } else if (yaml.has("body_T_cam0")) {
    set_extrinsic(yaml, "body_T_cam0", yaml.pose("body_T_cam0"));
  } else if (yaml.has("extrinsicRotation")) {
    const std::optional<Pose> T_b_c =
        pose_of(yaml.numbers("extrinsicRotation"), yaml.numbers("extrinsicTranslation"));
    if (!T_b_c) yaml.fail("extrinsicRotation", "and extrinsicTranslation are no rotation and 3 numbers");
    set_extrinsic(yaml, "extrinsicRotation", *T_b_c);
  }
  if (yaml.has("td")) {
    result_.rig.time_offset_s = yaml.number("td");
    note("td");
  }
  if (yaml.has("rolling_shutter") && yaml.number("rolling_shutter") != 0.0) {
    result_.rig.rolling_shutter_s = yaml.positive("rolling_shutter_tr");
    note("rolling_shutter_tr");
  }
  if (yaml.has("acc_n"))
    note("acc_n, gyr_n, acc_w and gyr_w of VINS are noises of a sample, and are not read");
}

}  // namespace

OverriddenRig apply_rig_yaml(const std::filesystem::path& file, const Rig& rig) {
  YamlRig yaml(file, rig);
  yaml.read();
  return std::move(yaml).result();
}

}  // namespace stillpoint::datasets
