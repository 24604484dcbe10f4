// SPDX-License-Identifier: BSD-3-Clause
/// Frames with the results of the odometry drawn onto them, written as JPEG files and as a video: all of a
/// run, or the worst ones only.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/pipeline/runners/runner.h"
#include "datasets/sensor_stream.h"
#include "eval/metrics/frame_to_frame_error.h"
#include "reports/frames/video_module.h"

namespace stillpoint::report {

/// Drawing sizes; the circles are the tracker's circular masks. Paper Sec. III-A.
struct AnnotationStyle {
  int stable_radius_px = 0;       ///< 0 = no circles around features
  int unstable_radius_px = 0;     ///< 0 = no circles where tracking was lost
  std::size_t track_length = 10;  ///< frames
};

/// Radii of the circular masks that a tracker with this configuration uses.
[[nodiscard]] AnnotationStyle annotation_style(const FrontendConfig& frontend);

/// Color (R, G, B) of a feature: green stable, red on a dynamic object, magenta moving, white without a
/// label.
[[nodiscard]] cv::Scalar label_color(std::optional<LabelClass> label);

/// Draws odometry results onto a frame: detections, semantic mask, circular masks, features and their tracks.
/// Call it for every frame in order: tracks and lost features are derived from the preceding frames.
///
/// Green: stable. Red: on a dynamic object. Magenta: moving (moving consistency check). White: no label yet.
/// Thin circles suppress new features: orange around stable features, purple where a feature was lost in the
/// last frame (unstable). Red tint: depth below its box's threshold, Eq. (1). Boxes: yellow detected, blue
/// from missed detection compensation. After a correction by loop closure its size is written for 30 frames.
class FrameAnnotator {
 public:
  explicit FrameAnnotator(AnnotationStyle style) : style_(style) {}

  /// @return CV_8UC3 RGB, same size as the frame
  [[nodiscard]] cv::Mat annotate(const FrameReport& report);

  /// Updates the tracks without drawing.
  void update_tracks(const FrameReport& report) { tracks_ = extended_tracks(report); }

 private:
  struct Track {
    std::vector<cv::Point2d> pixels;  ///< oldest first
    bool has_label = false;
    LabelClass label = LabelClass::kStable;
  };
  using Tracks = std::map<std::int64_t, Track>;

  [[nodiscard]] Tracks extended_tracks(const FrameReport& report) const;
  void note_correction(const OdometryUpdate& update);
  void draw_circles(const Tracks& now, cv::Mat& canvas) const;

  AnnotationStyle style_;
  Tracks tracks_;       ///< of the features in the last frame
  Pose T_m_w_;          ///< `OdometryUpdate::T_m_w` of the last frame that was drawn
  bool in_map_ = true;  ///< same
  std::string correction_;
  int correction_frames_ = 0;  ///< for which it is still written
};

/// Encodes images to an .mp4 file: H.264 if OpenCV has an encoder for it, else MPEG-4. The file is complete
/// only after `finish`.
class VideoFile {
 public:
  /// @param size    of the images, both sides >= 2; an odd last row or column is cropped, as H.264 requires
  /// @param rate_hz > 0
  /// @throws InputError if the file cannot be written or no encoder is installed
  VideoFile(std::filesystem::path file, cv::Size size, double rate_hz);

  /// @param image CV_8UC3 RGB, of the size given to the constructor
  void add(const cv::Mat& image);

  /// Finalizes the file. @throws InputError if the disk is full
  void finish();

 private:
  std::filesystem::path file_;
  cv::Size size_;
  VideoSink encoder_;
};

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

/// Deletes the *.jpg files of a folder, and the folder if it is then empty. It need not exist.
void remove_images(const std::filesystem::path& folder);

/// Writes annotated images of a run's worst frames only: keeps `000042.jpg` for frame 42 if that is among the
/// frames with the largest frame-to-frame error so far; files that drop out of this set are deleted. At most
/// 400 px wide, about 25 kB each. They are collected in FOLDER.new until the run ends.
class WorstFrames {
 public:
  /// @param folder   created if missing
  /// @param capacity number of images to keep
  /// @throws InputError if the folder cannot be created
  WorstFrames(std::filesystem::path folder, std::size_t capacity, AnnotationStyle style,
              const datasets::SequenceInfo& info);
  ~WorstFrames();  ///< deletes the images without `finish`
  WorstFrames(const WorstFrames&) = delete;
  WorstFrames& operator=(const WorstFrames&) = delete;

  /// Frames in order. @throws InputError if a file cannot be written
  void add(const FrameReport& report);

  /// Replaces the *.jpg files of an earlier run in the folder. @throws std::filesystem::filesystem_error
  void finish();

 private:
  [[nodiscard]] std::optional<eval::MatchedPose> matched(const OdometryUpdate& update) const;
  [[nodiscard]] std::filesystem::path file_of(std::size_t frame) const;

  std::filesystem::path folder_;
  std::filesystem::path collected_;
  FrameAnnotator annotator_;
  eval::FrameToFrameError frame_to_frame_;
  eval::WorstFrames worst_;
  std::vector<std::optional<Pose>> truth_;  ///< T_w_c of each frame of the sequence
};

}  // namespace stillpoint::report
