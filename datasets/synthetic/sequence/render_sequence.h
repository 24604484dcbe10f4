// SPDX-License-Identifier: BSD-3-Clause
/// Renders a sequence into a folder in OpenLORIS or TUM RGB-D layout, with multiple threads, and keeps
/// rendered sequences in a cache on disk.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
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

/// Writes one sequence folder.
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
  std::filesystem::path folder_;
  SequenceLayout layout_;
};

/// Progress reporting, cancellation and thread count of a rendering; every member is optional.
struct RenderControl {
  std::function<void(int done, int total)> progress = {};  ///< called after each frame, serialized
  std::function<bool()> stop_requested = {};               ///< called before each frame, from any thread
  /// Called with the images of each frame, from any thread.
  std::function<void(std::size_t index, const cv::Mat& color, const cv::Mat& depth)> on_images = {};
  int threads = 0;  ///< 0 = hardware concurrency; does not affect the result
};

/// Writes the sequence into `folder`, which is created atomically when the sequence is complete. Besides the
/// files of the layout:
///   request.toml    the request
///   true_boxes.txt  bounding boxes of the visible pixels of each moving object; only timestamps in a static
///                   scene
///   detections.txt  output of a simulated person detector; likewise
///   labels/         on request: one 8-bit instance mask per frame; 0 = static, 1..127 = a person, 128.. = a
///                   moving object of a class that the detector does not report
///   motion/         with the labels: world-frame speed of the visible surface [cm/s], 8 bits, saturated
/// @return false if stopped by `control`; no files remain in that case
/// @throws InputError if the request is out of range, `folder` exists already, or a file cannot be written
bool render_sequence(const SynthRequest& request, const std::filesystem::path& folder,
                     const RenderControl& control = {});

/// Folder of the sequence; rendered first if it is not in the cache. Safe to call from several processes.
/// @return an empty path if stopped by `control`
/// @throws InputError as `render_sequence`, and if the cache cannot be written
[[nodiscard]] std::filesystem::path cached_sequence(const SynthRequest& request,
                                                    const RenderControl& control = {});

}  // namespace stillpoint::synth
