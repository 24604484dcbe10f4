// SPDX-License-Identifier: BSD-3-Clause
/// EuRoC MAV datasets (Burri et al., IJRR 2016), ASL folder layout: left camera and IMU.
#include <string>
#include <utility>
#include <vector>

#include "datasets/formats/formats.h"
#include "datasets/formats/image_lists.h"
#include "datasets/io/imu_file.h"
#include "datasets/io/sensor_yaml.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {
namespace {

/// The folder that contains cam0 and imu0: `folder` itself or its mav0.
std::filesystem::path sensors_folder(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "mav0") ? folder / "mav0" : folder;
}

void add_images(const std::filesystem::path& camera_folder, SequenceContent& content, FaultLog& faults) {
  for (const StampedFile& image : read_image_list(camera_folder / "data.csv", camera_folder / "data",
                                                  eval::TimeUnit::kNanoseconds, faults)) {
    content.info.frame_times.push_back(image.t);
    content.frame_files.push_back(FrameFiles{.color = image.file, .depth = {}, .depth_offset_s = 0.0});
  }
}

/// `content` with the ground truth of its folder, if there is one.
/// @param T_body_b pose of the IMU in the body frame of EuRoC
SequenceContent with_truth_of(SequenceContent content, const Pose& T_body_b, FaultLog& faults) {
  const std::filesystem::path sensors = sensors_folder(content.info.folder);
  const Pose T_c_b = content.info.rig.T_b_c.inverse();
  const std::filesystem::path estimate = sensors / "state_groundtruth_estimate0";
  if (std::filesystem::exists(estimate / "data.csv")) {
    content = with_ground_truth(std::move(content),
                                eval::read_euroc_ground_truth(estimate / "data.csv", "body", faults));
    content.info.ground_truth.T_c_f =
        T_c_b * T_body_b.inverse() * SensorYaml(estimate / "sensor.yaml").pose("T_BS");
    return content;
  }
  const std::filesystem::path text = sensors.parent_path() / "groundtruth_tum.txt";
  if (!std::filesystem::exists(text)) return content;
  content = with_ground_truth(std::move(content), eval::read_tum_ground_truth(text, "imu", faults));
  content.info.ground_truth.T_c_f = T_c_b;
  return content;
}

SequenceContent read_euroc(const std::filesystem::path& folder, FaultLog& faults) {
  const std::filesystem::path sensors = sensors_folder(folder);
  SequenceContent content;
  content.info.name = folder.filename().string();
  content.info.folder = folder;
  add_images(sensors / "cam0", content, faults);
  content.info.imu = read_imu_file(sensors / "imu0" / "data.csv", eval::TimeUnit::kNanoseconds, faults);

  const SensorYaml camera(sensors / "cam0" / "sensor.yaml");
  const SensorYaml imu(sensors / "imu0" / "sensor.yaml");
  const Pose T_body_b = imu.pose("T_BS");
  Rig& rig = content.info.rig;
  rig.camera = camera.camera();
  rig.has_imu = true;
  rig.T_b_c = T_body_b.inverse() * camera.pose("T_BS");
  rig.imu_noise = imu.imu_noise();
  return with_truth_of(std::move(content), T_body_b, faults);
}

bool recognize_euroc(const std::filesystem::path& folder) {
  return std::filesystem::exists(sensors_folder(folder) / "cam0" / "data.csv");
}

}  // namespace

const SequenceFormat kEurocFormat{
    .name = "euroc", .signature = "mav0/cam0/data.csv", .recognize = recognize_euroc, .read = read_euroc};

}  // namespace stillpoint::datasets
