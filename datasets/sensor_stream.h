// SPDX-License-Identifier: BSD-3-Clause
/// One recorded or rendered sequence, whatever its layout on disk: facts at once, pictures on demand.
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

namespace stillpoint {

/// True path of one frame f of the robot, and where that frame sits.
struct GroundTruth {
  Trajectory trajectory;  ///< poses T_w_f, f = trajectory.frame; empty when the sequence has none
  Pose T_c_f;             ///< frame f in the camera: T_w_c = T_w_f * T_c_f.inverse()
};

/// Everything of a sequence but its pictures.
struct SequenceInfo {
  std::string name;  ///< the folder's name
  std::filesystem::path folder;
  std::string format;  ///< "tum", "openloris", "euroc", "7scenes"
  Rig rig;
  std::vector<Timestamp> frame_times;  ///< one per frame, strictly rising
  std::vector<ImuSample> imu;          ///< strictly rising; empty without an IMU
  GroundTruth ground_truth;
  std::vector<DetectionSet> detections;  ///< recorded boxes in order of time; empty when there are none
  std::vector<DetectionSet> true_boxes;  ///< of everything that moves, in order of time; rendered sequences
  std::vector<std::string> notes;        ///< what the reader assumed, a sentence each, for the user to see
};

/// What a renderer knows of every pixel of a frame.
struct MotionLabels {
  cv::Mat object;  ///< CV_8UC1: 0 = the standing world, 1..127 = a person, 128.. = a mover no detector knows
  cv::Mat speed_cm_per_s;  ///< CV_8UC1: of what is seen, in the world; cut at 255
};
constexpr int kFirstUnknownMover = 128;

/// A sequence opened for reading. Implementations hold no picture longer than a call.
class SensorStream {
 public:
  virtual ~SensorStream() = default;
  [[nodiscard]] virtual const SequenceInfo& info() const = 0;

  /// Decodes the pictures of one frame; safe to call from several threads at once.
  /// @param index position in `info().frame_times`
  /// @throws InputError with the file's name if a picture is missing, truncated, or of another size than the
  /// rig says
  [[nodiscard]] virtual Frame load_frame(std::size_t index) const = 0;

  /// Decodes the labels of one frame, if the sequence was rendered with them. As `load_frame` otherwise.
  [[nodiscard]] virtual std::optional<MotionLabels> load_labels(std::size_t index) const = 0;
};

/// How to open a folder; empty fields mean "find out".
struct OpenOptions {
  std::string format;              ///< one of SequenceInfo::format
  std::filesystem::path rig_file;  ///< a rig.toml that overrides the format's calibration
};

/// Opens a sequence folder; its kind is recognised from its files.
/// @throws InputError if the folder is not a sequence, or any text file in it is unreadable, unsorted or not
/// finite
[[nodiscard]] std::unique_ptr<SensorStream> open_sequence(const std::filesystem::path& folder,
                                                          const OpenOptions& options = {});

}  // namespace stillpoint
