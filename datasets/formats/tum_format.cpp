// SPDX-License-Identifier: BSD-3-Clause
/// TUM RGB-D benchmark (Sturm et al., IROS 2012) and folders with the same layout.
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "datasets/formats/formats.h"
#include "datasets/formats/image_lists.h"
#include "datasets/io/imu_file.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {
namespace {

constexpr double kTumDepthUnitsPerM = 5000.0;

/// Names of folders of the Bonn RGB-D Dynamic dataset contain this.
constexpr std::string_view kBonn = "rgbd_bonn";

/// Color camera of one of the three Kinects of the benchmark, or of a dataset in its layout.
struct KinectCalibration {
  std::string_view name;
  Camera camera;
};

/// The first three: from the page "File Formats" of the benchmark, section on intrinsic calibration (not the
/// ROS default; the published depth images are already scale-corrected).
const std::array<KinectCalibration, 4>& kinects() {
  static const std::array<KinectCalibration, 4> kAll{
      {{"freiburg1",
        {.width = 640,
         .height = 480,
         .fx = 517.3,
         .fy = 516.5,
         .cx = 318.6,
         .cy = 255.3,
         .model = CameraModel::kRadialTangential,
         .distortion = {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}}},
       {"freiburg2",
        {.width = 640,
         .height = 480,
         .fx = 520.9,
         .fy = 521.0,
         .cx = 325.1,
         .cy = 249.7,
         .model = CameraModel::kRadialTangential,
         .distortion = {0.2312, -0.7849, -0.0033, -0.0001, 0.9172}}},
       {"freiburg3",
        {.width = 640,
         .height = 480,
         .fx = 535.4,
         .fy = 539.2,
         .cx = 320.1,
         .cy = 247.6,
         .model = CameraModel::kRadialTangential,
         .distortion = {}}},
       {kBonn,  // Palazzolo et al., IROS 2019
        {.width = 640,
         .height = 480,
         .fx = 542.822841,
         .fy = 542.576870,
         .cx = 315.593520,
         .cy = 237.756098,
         .model = CameraModel::kRadialTangential,
         .distortion = {0.039903, -0.099343, -0.000730, -0.000144, 0.0}}}}};
  return kAll;
}

void set_calibration(SequenceContent& content) {
  Rig& rig = content.info.rig;
  rig.depth_units_per_m = kTumDepthUnitsPerM;
  for (const KinectCalibration& kinect : kinects()) {
    if (content.info.name.find(kinect.name) == std::string::npos) continue;
    rig.camera = kinect.camera;
    content.info.notes.push_back("calibration: published values of " + std::string(kinect.name));
    return;
  }
  content.missing_calibration =
      "the folder name contains none of freiburg1, freiburg2, freiburg3, rgbd_bonn, whose cameras are known";
}

void add_imu(SequenceContent& content, FaultLog& faults) {
  const std::filesystem::path txt = content.info.folder / "imu.txt";
  const std::filesystem::path csv = content.info.folder / "imu.csv";
  if (std::filesystem::exists(txt)) {
    content.info.imu = read_imu_file(txt, eval::TimeUnit::kSeconds, faults);
  } else if (std::filesystem::exists(csv)) {
    content.info.imu = read_imu_file(csv, eval::TimeUnit::kNanoseconds, faults);
  } else {
    return;
  }
  content.info.rig.has_imu = true;
  content.extrinsic_known = false;
  content.info.notes.emplace_back(
      "imu: default noise densities, unless a rig.toml sets [imu] gyro_noise etc.");
}

SequenceContent read_tum(const std::filesystem::path& folder, FaultLog& faults) {
  SequenceContent content;
  content.info.name = folder.filename().string();
  content.info.folder = folder;
  // The lists of the Bonn dataset name images that its archives lack.
  const bool is_bonn = content.info.name.find(kBonn) != std::string::npos;
  content =
      with_frames(std::move(content), pair_images(folder / "rgb.txt", folder / "depth.txt", faults,
                                                  is_bonn ? MissingImages::kDrop : MissingImages::kKeep));
  set_calibration(content);
  add_imu(content, faults);
  if (std::filesystem::exists(folder / "groundtruth.txt")) {
    content = with_ground_truth(std::move(content),
                                eval::read_tum_ground_truth(folder / "groundtruth.txt", "camera", faults));
  }
  return content;
}

bool recognize_tum(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "rgb.txt");
}

}  // namespace

const SequenceFormat kTumFormat{
    .name = "tum", .signature = "rgb.txt", .recognize = recognize_tum, .read = read_tum};

}  // namespace stillpoint::datasets
