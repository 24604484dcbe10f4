// SPDX-License-Identifier: BSD-3-Clause
/// Result of a format reader: the metadata of the sequence and the paths of its image files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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
  std::vector<FrameFiles> frame_files;      ///< one per info.frame_times; with `images`, names for messages
  std::optional<ImageSource> images;        ///< set if the images are not files
  eval::RowRepairs truth_repairs;           ///< of the ground-truth file
  bool extrinsic_known = true;              ///< whether the format provides the camera-IMU extrinsic
  std::string missing_calibration;          ///< why the format does not know the camera, if it does not
  std::uint16_t no_depth_value = 0;         ///< raw value, besides 0, that means "not measured"
  std::optional<DepthCamera> depth_camera;  ///< set if depth is not yet registered to the color camera
};

/// `content` with a ground-truth trajectory.
[[nodiscard]] inline SequenceContent with_ground_truth(SequenceContent content,
                                                       eval::LoadedTrajectory truth) {
  content.info.ground_truth.trajectory = std::move(truth.trajectory);
  content.truth_repairs = truth.repairs;
  return content;
}

}  // namespace stillpoint::datasets
