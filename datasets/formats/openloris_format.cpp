// SPDX-License-Identifier: BSD-3-Clause
/// OpenLORIS-Scene packages (Shi et al., ICRA 2020), the D435i part.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "datasets/calibration/transform_graph.h"
#include "datasets/formats/formats.h"
#include "datasets/formats/image_lists.h"
#include "datasets/io/imu_file.h"
#include "datasets/io/sensor_yaml.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {
namespace {

constexpr const char* kCamera = "d400_color_optical_frame";
constexpr const char* kGyroscope = "d400_gyroscope";
constexpr const char* kAccelerometer = "d400_accelerometer";
constexpr const char* kGroundTruthFrame = "base_link";
constexpr double kMaxImuMisalignment = 1e-3;  ///< [m, rad] between the poses of gyroscope and accelerometer

Camera openloris_camera(const SensorYaml& sensor) {
  Camera camera = sensor.with_distortion(Camera{});
  camera.width = sensor.positive_int("width");
  camera.height = sensor.positive_int("height");
  const std::vector<double> values = sensor.numbers("intrinsics");  // fx, cx, fy, cy
  if (values.size() != 4 || values[0] <= 0.0 || values[2] <= 0.0) {
    sensor.fail("intrinsics", "must be the four numbers fx, cx, fy, cy");
  }
  camera.fx = values[0];
  camera.cx = values[1];
  camera.fy = values[2];
  camera.cy = values[3];
  return camera;
}

/// Noise density [unit/sqrt(Hz)]: square root of the mean variance of the axes.
double density(const SensorYaml& sensor, const std::string& key) {
  const std::vector<double> variances = sensor.numbers(key);
  double sum = 0.0;
  for (const double variance : variances) sum += variance;
  if (variances.empty() || !(sum > 0.0)) sensor.fail(key, "must contain variances greater than 0");
  return std::sqrt(sum / static_cast<double>(variances.size()));
}

ImuNoise noise_of(const SensorYaml& sensors) {
  const SensorYaml gyro = sensors.child(kGyroscope);
  const SensorYaml accel = sensors.child(kAccelerometer);
  return ImuNoise{.gyro_noise = density(gyro, "noise_variances"),
                  .accel_noise = density(accel, "noise_variances"),
                  .gyro_walk = density(gyro, "bias_variances"),
                  .accel_walk = density(accel, "bias_variances")};
}

std::vector<NamedTransform> read_links(const std::filesystem::path& file) {
  std::vector<NamedTransform> links;
  for (const SensorYaml& entry : SensorYaml(file).list("trans_matrix")) {
    links.push_back(NamedTransform{.parent = entry.text("parent_frame"),
                                   .child = entry.text("child_frame"),
                                   .T_parent_child = entry.pose("matrix")});
  }
  return links;
}

Pose require_transform(const std::filesystem::path& file, const std::vector<NamedTransform>& links,
                       const std::string& a, const std::string& b) {
  const std::optional<Pose> T_a_b = find_transform(links, a, b);
  if (!T_a_b) throw InputError(file.string(), "no chain of transforms connects " + a + " and " + b);
  return *T_a_b;
}

/// The body frame is that of the gyroscope; an accelerometer with another pose would require a lever arm.
void set_extrinsics(SequenceContent& content, const std::filesystem::path& file) {
  const std::vector<NamedTransform> links = read_links(file);
  if (content.info.rig.has_imu) {
    const Pose T_g_a = require_transform(file, links, kGyroscope, kAccelerometer);
    const double angle = Eigen::AngleAxisd(T_g_a.q).angle();
    if (T_g_a.p.norm() > kMaxImuMisalignment || angle > kMaxImuMisalignment) {
      throw InputError(file.string(),
                       "gyroscope and accelerometer have different poses, which is not supported");
    }
    content.info.rig.T_b_c = require_transform(file, links, kGyroscope, kCamera);
  }
  if (!content.info.ground_truth.trajectory.poses.empty()) {
    content.info.ground_truth.T_c_f = require_transform(file, links, kCamera, kGroundTruthFrame);
  }
}

void add_openloris_imu(SequenceContent& content, FaultLog& faults) {
  const std::filesystem::path gyro_file = content.info.folder / "d400_gyroscope.txt";
  const std::filesystem::path accel_file = content.info.folder / "d400_accelerometer.txt";
  if (!std::filesystem::exists(gyro_file) && !std::filesystem::exists(accel_file)) return;
  const std::vector<VectorSample> gyro = read_vector_file(gyro_file, kGyroscopeRange, faults);
  const std::vector<VectorSample> accel = read_vector_file(accel_file, kAccelerometerRange, faults);
  content.info.imu = merge_onto_gyro(gyro, accel);
  content.info.rig.has_imu = true;
  faults.guard([&] {
    if (content.info.imu.empty()) {
      throw InputError(gyro_file.string(), "no sample lies within the time span of d400_accelerometer.txt");
    }
  });
}

SequenceContent read_openloris(const std::filesystem::path& folder, FaultLog& faults) {
  SequenceContent content;
  content.info.name = folder.filename().string();
  content.info.folder = folder;
  content = with_frames(std::move(content),
                        pair_images(folder / "color.txt", folder / "aligned_depth.txt", faults));
  add_openloris_imu(content, faults);
  if (std::filesystem::exists(folder / "groundtruth.txt")) {
    content = with_ground_truth(std::move(content), eval::read_tum_ground_truth(folder / "groundtruth.txt",
                                                                                kGroundTruthFrame, faults));
  }
  const SensorYaml sensors(folder / "sensors.yaml");
  content.info.rig.camera = openloris_camera(sensors.child(kCamera));
  if (content.info.rig.has_imu) content.info.rig.imu_noise = noise_of(sensors);
  set_extrinsics(content, folder / "trans_matrix.yaml");
  return content;
}

bool recognize_openloris(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "color.txt") &&
         std::filesystem::exists(folder / "aligned_depth.txt");
}

}  // namespace

const SequenceFormat kOpenLorisFormat{.name = "openloris",
                                      .signature = "color.txt and aligned_depth.txt",
                                      .recognize = recognize_openloris,
                                      .read = read_openloris};

}  // namespace stillpoint::datasets
