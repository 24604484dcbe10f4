// SPDX-License-Identifier: BSD-3-Clause
/// The supported sequence formats: what a reader returns (the metadata of a sequence and the paths of its
/// image files), and the list of the readers. A new format is one file in this folder, which defines a
/// `SequenceFormat`, and its declaration and entry in the list below.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/base/error.h"
#include "datasets/calibration/depth_registration.h"
#include "datasets/io/sequence_info.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {

struct FrameFiles {
  std::filesystem::path color;
  std::filesystem::path depth;  ///< empty when the sequence has no depth
  double depth_offset_s = 0.0;  ///< timestamp of the depth image minus that of the color image
};

/// Identifies the content of the images of one frame; 0 = no image.
struct FrameDigest {
  std::uint64_t color = 0;
  std::uint64_t depth = 0;
  bool operator==(const FrameDigest&) const = default;
};

/// Images that are not files of their own, e.g. messages of a bag. The functions are thread-safe, return
/// images like `read_image` and `read_depth`, and throw InputError like them.
struct ImageSource {
  std::function<cv::Mat(std::size_t frame)> color;
  std::function<cv::Mat(std::size_t frame)> depth;
  std::function<FrameDigest(std::size_t frame)> digest;  ///< without reading the images
};

struct SequenceContent {
  SequenceInfo info;
  std::vector<FrameFiles> frame_files;  ///< one per info.frame_times; with `images`, names for messages
  std::optional<ImageSource> images;    ///< set if the images are not files
  eval::RowRepairs truth_repairs;       ///< of the ground-truth file
  /// Mirrors a pose of the ground truth, as the format mirrors its camera; not used with another camera.
  Pose (*mirrored_truth)(const Pose& T_w_f) = nullptr;
  bool extrinsic_known = true;       ///< whether the format provides the camera-IMU extrinsic
  std::string missing_calibration;   ///< why the format does not know the camera, if it does not
  std::uint16_t no_depth_value = 0;  ///< raw value, besides 0, that means "not measured"
  bool raw_depth = false;            ///< do not register depth images of `info.depth_camera`
};

/// `content` with a ground-truth trajectory.
[[nodiscard]] inline SequenceContent with_ground_truth(SequenceContent content,
                                                       eval::LoadedTrajectory truth) {
  content.info.ground_truth.trajectory = std::move(truth.trajectory);
  content.truth_repairs = truth.repairs;
  return content;
}

/// Reader of one sequence folder layout.
struct SequenceFormat {
  std::string_view name;       ///< in options, messages and `SequenceInfo::format`
  std::string_view signature;  ///< files by which it is recognized, for messages
  bool (*recognize)(const std::filesystem::path& folder);
  SequenceContent (*read)(const std::filesystem::path& folder, FaultLog& faults);
};

/// TUM RGB-D: rgb.txt, depth.txt, groundtruth.txt; optionally imu.txt (`t wx wy wz ax ay az`, t in seconds)
/// or imu.csv (the same with t in ns), which require the extrinsic T_b_c in rig.toml.
extern const SequenceFormat kTumFormat;

/// OpenLORIS-Scene package of the D435i: color, aligned depth, separate gyroscope and accelerometer files.
extern const SequenceFormat kOpenLorisFormat;

/// EuRoC ASL: left camera and IMU; no depth.
extern const SequenceFormat kEurocFormat;

/// Microsoft 7-Scenes: numbered frames with one pose each, no timestamps.
extern const SequenceFormat kSevenScenesFormat;

/// Bags of ROS 1 (.bag) and ROS 2 (.mcap, .db3, folders of rosbag2), and recordings of librealsense.
extern const SequenceFormat kBagFormat;

/// ETH3D SLAM: lists like TUM RGB-D, calibration.txt; with or without depth.
extern const SequenceFormat kEth3dFormat;

/// ICL-NUIM in the layout of TUM RGB-D: associations.txt with frame numbers, published with fy < 0.
extern const SequenceFormat kIclNuimFormat;

/// TUM VI, exported in EuRoC format: left fisheye camera and IMU; no depth.
extern const SequenceFormat kTumViFormat;

/// CID-SIMS: images named by time, imu.txt, pose.txt; the camera must be given in rig.toml.
extern const SequenceFormat kCidSimsFormat;

/// Plain folders color/ and depth/ with images of equal names; calibration from a JSON file or rig.toml.
extern const SequenceFormat kFolderFormat;

/// All formats, in the order of detection.
inline constexpr std::array kSequenceFormats{
    &kBagFormat,   &kEth3dFormat, &kTumFormat,         &kIclNuimFormat, &kOpenLorisFormat,
    &kTumViFormat, &kEurocFormat, &kSevenScenesFormat, &kCidSimsFormat, &kFolderFormat};

}  // namespace stillpoint::datasets
