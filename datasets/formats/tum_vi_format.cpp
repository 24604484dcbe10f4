// SPDX-License-Identifier: BSD-3-Clause
/// TUM VI benchmark (Schubert et al., IROS 2018), exported in EuRoC format: fisheye cameras, images of 8 or
/// 16 bits, no depth, calibration by Kalibr in dso/.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/formats/formats.h"
#include "datasets/formats/image_lists.h"
#include "datasets/io/file_descriptor.h"
#include "datasets/io/image_io.h"
#include "datasets/io/imu_file.h"
#include "datasets/io/sensor_yaml.h"
#include "eval/io/matrix_files.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {
namespace {

/// Archives "512_16" contain gray images of 16 bits, of which the upper 8 are used.
cv::Mat read_gray_of_any_depth(const std::filesystem::path& file) {
  try {
    return read_image(file);
  } catch (const InputError&) {
    const cv::Mat deep = read_depth(file);  // throws if the file is damaged
    cv::Mat gray;
    deep.convertTo(gray, CV_8UC1, 1.0 / 256.0, -0.5 + 1.0 / 512.0);  // rounds down
    return gray;
  }
}

std::uint64_t state_hash(const std::filesystem::path& file) {
  const FileState state = file_state(file).value_or(FileState{});
  return content_hash(file.string() + " " + std::to_string(state.size) + " " +
                      std::to_string(state.modified_ns));
}

ImageSource gray_images(std::vector<FrameFiles> files) {
  const auto shared = std::make_shared<const std::vector<FrameFiles>>(std::move(files));
  return {.color = [shared](std::size_t frame) { return read_gray_of_any_depth((*shared)[frame].color); },
          .depth = {},
          .digest =
              [shared](std::size_t frame) {
                return FrameDigest{.color = state_hash((*shared)[frame].color), .depth = 0};
              }};
}

void set_tum_vi_rig(SequenceContent& content) {
  const std::filesystem::path calibration = content.info.folder / "dso";
  const SensorYaml camera = SensorYaml(calibration / "camchain.yaml").child("cam0");
  Rig& rig = content.info.rig;
  rig.camera = camera.camera();
  rig.has_imu = true;
  rig.T_b_c = camera.pose("T_cam_imu").inverse();
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
  content.images = gray_images(content.frame_files);
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
