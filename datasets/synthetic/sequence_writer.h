// SPDX-License-Identifier: BSD-3-Clause
/// The text files of a rendered sequence, in the layout of an OpenLORIS package or of a TUM RGB-D folder.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/types/detection.h"
#include "core/types/rig.h"
#include "core/types/trajectory.h"
#include "datasets/synthetic/presets.h"

namespace stillpoint {

/// Whole microseconds, as in the names of pictures: "1700000000.033333".
[[nodiscard]] std::string picture_stamp(Timestamp t);

/// Writes into one folder; files appear in the layout of the request.
class SequenceWriter {
 public:
  /// Makes the folders for the pictures. @throws InputError if that is not possible
  SequenceWriter(const std::filesystem::path& folder, SequenceLayout layout, bool labels);

  /// Safe to call from several threads at once.
  void write_pictures(Timestamp t, const cv::Mat& color, const cv::Mat& depth) const;
  void write_labels(Timestamp t, const cv::Mat& labels, const cv::Mat& motion) const;

  void write_lists(const std::vector<Timestamp>& frames) const;
  void write_rig(const Rig& rig, const SynthRequest& request) const;
  void write_inertia(const InertialRecord& record) const;
  /// @param camera_path poses of the camera
  void write_ground_truth(const Trajectory& camera_path) const;
  /// What was asked for, as `request.toml`.
  void write_request(const SynthRequest& request) const;
  /// As `read_detections` reads it.
  void write_boxes(const std::string& file, const std::vector<DetectionSet>& sets) const;

 private:
  std::filesystem::path folder_;
  SequenceLayout layout_;
};

}  // namespace stillpoint
