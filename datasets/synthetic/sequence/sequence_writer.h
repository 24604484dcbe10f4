// SPDX-License-Identifier: BSD-3-Clause
/// Writes the files of a rendered sequence in OpenLORIS or TUM RGB-D layout.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/types/detection.h"
#include "core/types/rig.h"
#include "core/types/trajectory.h"
#include "datasets/synthetic/sequence/presets.h"
#include "datasets/synthetic/sequence/recorded_motion.h"

namespace stillpoint::synth {

/// Timestamp in whole microseconds as used in image file names: "1700000000.033333".
[[nodiscard]] std::string image_stamp(Timestamp t);

/// Timestamps of the two images of a frame.
struct ImageStamps {
  Timestamp color;
  Timestamp depth;
};

/// Writes one sequence folder. Every file gets its name when it is complete, so that several processes can
/// write the same sequence into one folder.
class SequenceWriter {
 public:
  /// Creates the image folders. @throws InputError on failure
  SequenceWriter(const std::filesystem::path& folder, SequenceLayout layout, bool labels);

  /// Thread-safe.
  void write_images(const ImageStamps& stamps, const cv::Mat& color, const cv::Mat& depth) const;
  void write_labels(Timestamp t, const cv::Mat& labels, const cv::Mat& motion) const;

  void write_lists(const FrameTimes& frames) const;
  void write_rig(const Rig& rig, const SynthRequest& request) const;
  void write_imu(const ImuRecord& record) const;
  /// @param camera_path poses of the camera
  void write_ground_truth(const Trajectory& camera_path) const;
  /// Writes `request.toml`.
  void write_request(const SynthRequest& request) const;
  /// Writes the format of `read_detections`.
  void write_boxes(const std::string& file, const std::vector<DetectionSet>& sets) const;

 private:
  void write_text(const std::string& name, const std::string& text) const;

  std::filesystem::path folder_;
  SequenceLayout layout_;
};

}  // namespace stillpoint::synth
