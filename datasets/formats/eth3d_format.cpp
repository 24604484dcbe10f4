// SPDX-License-Identifier: BSD-3-Clause
/// ETH3D SLAM benchmark (Schöps et al., CVPR 2019): lists like TUM RGB-D, calibration in calibration.txt, no
/// distortion.
#include <string>
#include <utility>

#include "core/base/error.h"
#include "datasets/formats/formats.h"
#include "datasets/formats/image_lists.h"
#include "datasets/io/image_io.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {
namespace {

constexpr double kEth3dDepthUnitsPerM = 5000.0;

/// `fx fy cx cy` [px]; the pixel (0, 0) is the center of the first pixel, as in `Camera`. The image size is
/// that of the first image.
Camera eth3d_camera(const std::filesystem::path& file, const std::filesystem::path& first_image,
                    FaultLog& faults) {
  Camera camera;
  eval::for_each_row(eval::read_text_file(file), file.string(), faults, [&](const eval::TextRow& row) {
    camera.fx = row.finite_number(0);
    camera.fy = row.finite_number(1);
    camera.cx = row.finite_number(2);
    camera.cy = row.finite_number(3);
  });
  if (camera.fx <= 0.0 || camera.fy <= 0.0)
    throw InputError(file.string(), "contains no calibration; expected the four numbers fx fy cx cy");
  const cv::Mat image = read_image(first_image);
  camera.width = image.cols;
  camera.height = image.rows;
  return camera;
}

/// The images without depth of the archives "mono".
SequenceContent with_color_only(SequenceContent content, FaultLog& faults) {
  const std::filesystem::path& folder = content.info.folder;
  for (const StampedFile& image :
       read_image_list(folder / "rgb.txt", folder, eval::TimeUnit::kSeconds, faults)) {
    content.info.frame_times.push_back(image.t);
    content.frame_files.push_back(FrameFiles{.color = image.file, .depth = {}});
  }
  return content;
}

SequenceContent read_eth3d(const std::filesystem::path& folder, FaultLog& faults) {
  SequenceContent content;
  content.info.name = folder.filename().string();
  content.info.folder = folder;
  content =
      std::filesystem::exists(folder / "depth.txt")
          ? with_frames(std::move(content), pair_images(folder / "rgb.txt", folder / "depth.txt", faults))
          : with_color_only(std::move(content), faults);
  content.info.rig.camera =
      eth3d_camera(folder / "calibration.txt", content.frame_files.front().color, faults);
  content.info.rig.depth_units_per_m = kEth3dDepthUnitsPerM;
  content.info.notes.emplace_back("calibration: calibration.txt; images have no distortion");
  if (std::filesystem::exists(folder / "groundtruth.txt"))
    content = with_ground_truth(std::move(content),
                                eval::read_tum_ground_truth(folder / "groundtruth.txt", "camera", faults));
  return content;
}

bool recognize_eth3d(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "rgb.txt") && std::filesystem::exists(folder / "calibration.txt");
}

}  // namespace

const SequenceFormat kEth3dFormat{.name = "eth3d",
                                  .signature = "rgb.txt and calibration.txt",
                                  .recognize = recognize_eth3d,
                                  .read = read_eth3d};

}  // namespace stillpoint::datasets
