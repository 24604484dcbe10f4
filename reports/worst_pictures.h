// SPDX-License-Identifier: BSD-3-Clause
/// Annotated pictures of the frames at which a run's error grew most, and of no others.
#pragma once

#include <filesystem>
#include <vector>

#include "core/types/trajectory.h"
#include "datasets/sensor_stream.h"
#include "eval/metrics/error_growth.h"
#include "reports/picture_annotator.h"

namespace stillpoint {

/// Keeps `000042.jpg` for frame 42 in a folder while the run goes on: what becomes too good for it is removed
/// again. At most 400 px wide, some 25 kB each.
class WorstPictures {
 public:
  /// @param folder is made if it is missing; pictures of an earlier run in it are removed
  /// @param room how many to keep
  /// @throws InputError if the folder cannot be made
  WorstPictures(std::filesystem::path folder, std::size_t room, AnnotationStyle style,
                const SequenceInfo& info);

  /// Pictures in order. @throws InputError if a file cannot be written
  void add(const PictureReport& report);

 private:
  [[nodiscard]] std::optional<MatchedPose> matched(const OdometryUpdate& update) const;
  [[nodiscard]] std::filesystem::path file_of(std::size_t frame) const;

  std::filesystem::path folder_;
  PictureAnnotator annotator_;
  ErrorGrowth growth_;
  WorstFrames worst_;
  std::vector<std::optional<Pose>> truth_;  ///< T_w_c of each frame of the sequence
};

/// The circles that the tracker of this configuration keeps.
[[nodiscard]] AnnotationStyle annotation_style(const FrontendConfig& frontend);

}  // namespace stillpoint
