// SPDX-License-Identifier: BSD-3-Clause
/// TUM VI benchmark (Schubert et al., IROS 2018), exported in EuRoC format: fisheye cameras, images of 8 or
/// 16 bits, no depth, calibration by Kalibr in dso/.
#include <string>
#include <utility>

#include "datasets/formats/formats.h"
#include "datasets/formats/image_lists.h"
#include "datasets/io/imu_file.h"
#include "datasets/io/sensor_yaml.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {
namespace {

void set_tum_vi_rig(SequenceContent& content) {
  const std::filesystem::path calibration = content.info.folder / "dso";
  const SensorYaml camera = SensorYaml(calibration / "camchain.yaml").child("cam0");
  Rig& rig = content.info.rig;
  rig.camera = camera.camera();
  rig.has_imu = true;
  rig.T_b_c = camera.pose("T_cam_imu").inverse();
  if (camera.has("timeshift_cam_imu")) rig.time_offset_s = camera.number("timeshift_cam_imu");
  rig.imu_noise = SensorYaml(calibration / "imu_config.yaml").imu_noise();
}

SequenceContent read_tum_vi(const std::filesystem::path& folder, FaultLog& faults) {
  const std::filesystem::path sensors = folder / "mav0";
  SequenceContent content;
  content.info.name = folder.filename().string();
  content.info.folder = folder;
  for (const StampedFile& image : read_image_list(sensors / "cam0" / "data.csv", sensors / "cam0" / "data",
                                                  eval::TimeUnit::kNanoseconds, faults)) {
    content.info.frame_times.push_back(image.t);
    content.frame_files.push_back(FrameFiles{.color = image.file, .depth = {}});
  }
  content.info.imu = read_imu_file(sensors / "imu0" / "data.csv", eval::TimeUnit::kNanoseconds, faults);
  set_tum_vi_rig(content);
  content.info.notes.emplace_back("images of 16 bits are read as their upper 8 bits");
  const std::filesystem::path truth = sensors / "mocap0" / "data.csv";
  if (!std::filesystem::exists(truth)) return content;
  content = with_ground_truth(std::move(content), eval::read_euroc_ground_truth(truth, "imu", faults));
  content.info.ground_truth.T_c_f = content.info.rig.T_b_c.inverse();
  return content;
}

bool recognize_tum_vi(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "mav0" / "cam0" / "data.csv") &&
         std::filesystem::exists(folder / "dso" / "camchain.yaml");
}

}  // namespace

const SequenceFormat kTumViFormat{.name = "tum-vi",
                                  .signature = "mav0/cam0/data.csv and dso/camchain.yaml",
                                  .recognize = recognize_tum_vi,
                                  .read = read_tum_vi};

}  // namespace stillpoint::datasets
