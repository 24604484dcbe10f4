// SPDX-License-Identifier: BSD-3-Clause
/// Writes annotated images of a run's worst frames only.
#pragma once

#include <filesystem>
#include <vector>

#include "core/types/trajectory.h"
#include "datasets/sensor_stream.h"
#include "eval/metrics/frame_to_frame_error.h"
#include "reports/frames/frame_annotator.h"

namespace stillpoint::report {

/// Keeps `000042.jpg` for frame 42 if that is among the frames with the largest frame-to-frame error so far;
/// files that drop out of this set are deleted. At most 400 px wide, about 25 kB each.
class WorstFrames {
 public:
  /// @param folder   created if missing; *.jpg files of an earlier run are deleted
  /// @param capacity number of images to keep
  /// @throws InputError if the folder cannot be created
  WorstFrames(std::filesystem::path folder, std::size_t capacity, AnnotationStyle style,
              const datasets::SequenceInfo& info);

  /// Frames in order. @throws InputError if a file cannot be written
  void add(const FrameReport& report);

 private:
  [[nodiscard]] std::optional<eval::MatchedPose> matched(const OdometryUpdate& update) const;
  [[nodiscard]] std::filesystem::path file_of(std::size_t frame) const;

  std::filesystem::path folder_;
  FrameAnnotator annotator_;
  eval::FrameToFrameError frame_to_frame_;
  eval::WorstFrames worst_;
  std::vector<std::optional<Pose>> truth_;  ///< T_w_c of each frame of the sequence
};

/// Radii of the circular masks that a tracker with this configuration uses.
[[nodiscard]] AnnotationStyle annotation_style(const FrontendConfig& frontend);

}  // namespace stillpoint::report
