// SPDX-License-Identifier: BSD-3-Clause
/// Format-independent access to a recorded or rendered sequence: metadata at once, images on demand.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/timestamp.h"
#include "core/types/detection.h"
#include "core/types/frame.h"
#include "core/types/imu_sample.h"
#include "core/types/rig.h"
#include "core/types/trajectory.h"

namespace stillpoint::datasets {

/// Ground-truth trajectory of one body-fixed frame f, and the pose of that frame relative to the camera.
struct GroundTruth {
  Trajectory trajectory;  ///< poses T_w_f, f = trajectory.frame; empty when the sequence has none
  Pose T_c_f;             ///< pose of f in the camera frame: T_w_c = T_w_f * T_c_f.inverse()
};

/// Everything of a sequence but its images.
struct SequenceInfo {
  std::string name;  ///< the folder's name
  std::filesystem::path folder;
  std::string format;  ///< "tum", "openloris", "euroc", "7scenes"
  Rig rig;
  std::vector<Timestamp> frame_times;  ///< one per frame, strictly increasing
  std::vector<ImuSample> imu;          ///< strictly increasing in time; empty without an IMU
  GroundTruth ground_truth;
  std::vector<DetectionSet> detections;  ///< recorded boxes in order of time; empty when there are none
  std::vector<DetectionSet> true_boxes;  ///< of all moving objects, in order of time; rendered sequences only
  std::vector<std::string> notes;        ///< assumptions made by the reader, one sentence each, to be shown
};

/// Per-pixel ground truth of a rendered frame.
struct MotionLabels {
  cv::Mat
      object;  ///< CV_8UC1: 0 = static scene, 1..127 = a person, 128.. = a moving object of no detector class
  cv::Mat speed_cm_per_s;  ///< CV_8UC1: speed of the visible surface in the world frame; saturates at 255
};
constexpr int kFirstUndetectableObject = 128;

/// A sequence opened for reading. Implementations do not cache images.
class SensorStream {
 public:
  virtual ~SensorStream() = default;
  [[nodiscard]] virtual const SequenceInfo& info() const = 0;

  /// Decodes the images of one frame; thread-safe.
  /// @param index position in `info().frame_times`
  /// @throws InputError with the file name if an image is missing, truncated, or its size differs from the
  /// calibrated size
  [[nodiscard]] virtual Frame load_frame(std::size_t index) const = 0;

  /// Decodes the labels of one frame; empty if the sequence has none. Otherwise like `load_frame`.
  [[nodiscard]] virtual std::optional<MotionLabels> load_labels(std::size_t index) const = 0;
};

/// How to open a folder; empty fields are detected automatically.
struct OpenOptions {
  std::string format;              ///< one of SequenceInfo::format
  std::filesystem::path rig_file;  ///< a rig.toml that overrides the calibration of the format
};

/// Opens a sequence folder; its format is detected from the files in it.
/// @throws InputError if the folder is not a sequence, or a text file in it is unreadable, unsorted or has
/// values that are not finite
[[nodiscard]] std::unique_ptr<SensorStream> open_sequence(const std::filesystem::path& folder,
                                                          const OpenOptions& options = {});

}  // namespace stillpoint::datasets
