// SPDX-License-Identifier: BSD-3-Clause
/// What a run of the odometry contributes to the batch estimation of the calibration: keyframes with their
/// poses and the static features that were tracked over them.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/types/nav_state.h"
#include "core/types/odometry_update.h"
#include "core/types/rig.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// A feature in a keyframe.
struct CalibrationFeature {
  std::int64_t track = 0;                                 ///< unique in a run
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();        ///< [px] in the (distorted) image
  Eigen::Vector2d velocity_px = Eigen::Vector2d::Zero();  ///< of the pixel [px/s], by the neighboring frames
  double depth_m = 0.0;                                   ///< measured [m]; 0 = not measured
};

struct CalibrationKeyframe {
  NavState state;  ///< as the odometry estimated it; the initial value of the batch, with the next
  Pose T_w_c;
  std::int64_t frame = 0;  ///< id
  cv::Mat depth;           ///< CV_16UC1 or empty
  cv::Mat gray;            ///< CV_8UC1; needed for edges of depth images that are not registered, else empty
  std::vector<CalibrationFeature> features;  ///< static ones, by ascending track
};

/// Consecutive keyframes in one world frame.
struct CalibrationSection {
  std::vector<CalibrationKeyframe> keyframes;           ///< by ascending time
  Eigen::Vector3d gravity_w = Eigen::Vector3d::Zero();  ///< direction [1]
};

/// Selects keyframes at a constant interval from the output of the odometry. Features whose track was labeled
/// dynamic at any time are left out.
class CalibrationCollector {
 public:
  /// @param interval_s smallest time between keyframes [s]
  explicit CalibrationCollector(double interval_s) : interval_s_(interval_s) {}

  /// The next frame. Frames without labels or without a pose become no keyframes.
  void add(const TrackedFrame& frame, std::span<const DynamicLabel> labels, const OdometryUpdate& update);

  /// One section per world frame of the odometry. Call it once, after the last frame.
  [[nodiscard]] std::vector<CalibrationSection> finish();

 private:
  void complete_velocities(const TrackedFrame& next);

  double interval_s_;
  std::vector<CalibrationSection> sections_;
  std::set<std::int64_t> dynamic_;
  TrackedFrame before_;        ///< the frame before the next one; features and time only
  bool is_pending_ = false;    ///< the newest keyframe is `before_`: its velocities lack the next frame
  Timestamp before_keyframe_;  ///< time of the frame before the newest keyframe
  int segment_ = -1;
};

}  // namespace stillpoint
