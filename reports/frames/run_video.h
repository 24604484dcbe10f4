// SPDX-License-Identifier: BSD-3-Clause
/// Writes annotated frames of a run as JPEG files and as a video.
#pragma once

#include <filesystem>
#include <optional>

#include "reports/frames/frame_annotator.h"
#include "reports/frames/video_file.h"

namespace stillpoint::report {

/// Writes `frames/000042.jpg` for frame 42, and all frames to `video.mp4`, below a folder.
class RunVideo {
 public:
  /// @param folder  created if missing
  /// @param rate_hz of the video; it plays faster than real time where the run dropped frames
  /// @throws InputError if the folder cannot be created
  RunVideo(std::filesystem::path folder, AnnotationStyle style, double rate_hz);

  /// Frames in order. @throws InputError if a file cannot be written
  void add(const FrameReport& report);

  /// Finalizes the video if any frame was added. @throws InputError if it cannot be written
  void finish();

 private:
  std::filesystem::path folder_;
  FrameAnnotator annotator_;
  double rate_hz_;
  std::optional<VideoFile> video_;  ///< opened with the size of the first frame
};

/// Mean frame rate [Hz]; 30 Hz with fewer than two stamps.
[[nodiscard]] double mean_rate_hz(const std::vector<Timestamp>& times);

}  // namespace stillpoint::report
