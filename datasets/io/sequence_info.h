// SPDX-License-Identifier: BSD-3-Clause
/// Contents of a sequence: metadata, ground truth, and the labels of rendered frames.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/timestamp.h"
#include "core/types/detection.h"
#include "core/types/frame.h"
#include "core/types/rig.h"
#include "core/types/trajectory.h"

namespace stillpoint::datasets {

/// Ground-truth trajectory of one body-fixed frame f, and the pose of that frame relative to the camera.
struct GroundTruth {
  Trajectory trajectory;  ///< poses T_w_f, f = trajectory.frame; empty when the sequence has none
  Pose T_c_f;             ///< pose of f in the camera frame: T_w_c = T_w_f * T_c_f.inverse()
};

/// Intrinsics and extrinsic of a depth camera whose images are not registered to the color camera.
struct DepthCamera {
  Camera camera;  ///< without distortion
  Pose T_c_d;     ///< depth camera to color camera
};

/// Everything of a sequence but its images.
struct SequenceInfo {
  std::string name;  ///< the folder's name
  std::filesystem::path folder;
  std::string format;  ///< name of its format, see datasets/formats/formats.h
  std::string id;      ///< identity of the content if the caller of `open_sequence` knew it; else empty
  Rig rig;
  std::optional<DepthCamera> depth_camera;  ///< of the depth images; absent: they are registered
  std::vector<Timestamp> frame_times;       ///< one per frame, strictly increasing
  std::vector<ImuSample> imu;               ///< strictly increasing in time; empty without an IMU
  GroundTruth ground_truth;
  std::vector<DetectionSet> detections;  ///< recorded boxes in order of time; empty when there are none
  std::vector<DetectionSet> true_boxes;  ///< of all moving objects, in order of time; rendered sequences only
  /// Injected faults of a detector, for the results of a network or a simulation; empty without such faults.
  std::function<DetectionSet(DetectionSet)> change_detections;
  std::vector<FrameArrival> arrivals;  ///< injected faults, in order of time; empty: at the timestamps
  std::vector<std::string> notes;      ///< assumptions made by the reader, one sentence each, to be shown
  std::vector<std::string> warnings;   ///< repaired faults of the files, as "LOCATION: FAULT", to be shown
};

/// Per-pixel ground truth of a rendered frame.
struct MotionLabels {
  cv::Mat
      object;  ///< CV_8UC1: 0 = static scene, 1..127 = a person, 128.. = a moving object of no detector class
  cv::Mat speed_cm_per_s;  ///< CV_8UC1: speed of the visible surface in the world frame; saturates at 255
};
constexpr int kFirstUndetectableObject = 128;

}  // namespace stillpoint::datasets
