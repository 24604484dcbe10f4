// SPDX-License-Identifier: BSD-3-Clause
/// Renders a whole sequence into a folder with multiple threads.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <opencv2/core/mat.hpp>

#include "datasets/synthetic/sequence/presets.h"

namespace stillpoint::synth {

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

}  // namespace stillpoint::synth
