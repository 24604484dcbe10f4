// SPDX-License-Identifier: BSD-3-Clause
/// A run as annotated pictures and as one video.
#pragma once

#include <filesystem>
#include <optional>

#include "reports/picture_annotator.h"
#include "reports/video_file.h"

namespace stillpoint {

/// Writes `frames/000042.jpg` for picture 42 and `video.mp4` of all, below a folder.
class RunVideo {
 public:
  /// @param folder is made if it is missing
  /// @param rate_hz of the video: pictures that a run drops make it shorter
  /// @throws InputError if the folder cannot be made
  RunVideo(std::filesystem::path folder, AnnotationStyle style, double rate_hz);

  /// Pictures in order. @throws InputError if a file cannot be written
  void add(const PictureReport& report);

  /// Completes the video, if there was a picture. @throws InputError if it cannot be written
  void finish();

 private:
  std::filesystem::path folder_;
  PictureAnnotator annotator_;
  double rate_hz_;
  std::optional<VideoFile> video_;  ///< from the first picture on, which knows the size
};

/// Mean rate of the pictures [Hz]; that of a usual camera, 30 Hz, where there are fewer than two.
[[nodiscard]] double mean_rate_hz(const std::vector<Timestamp>& times);

}  // namespace stillpoint
