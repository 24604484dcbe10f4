// SPDX-License-Identifier: BSD-3-Clause
/// Motion of the camera between frames by their features alone, independent of the states of the window.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/backend/vision/camera_pose.h"
#include "core/backend/window/window.h"
#include "core/geometry/covariance.h"

namespace stillpoint {

/// A pose determined by vision alone.
struct VisualPose {
  Timestamp t;  ///< on the IMU clock
  Pose T_w_b;
  /// See `UncertainPose`: of T_w_b, or if the pose was computed from an earlier one, of the motion T_b0_b
  /// since.
  Matrix6 covariance = Matrix6::Zero();
  int features = 0;           ///< that agree with it
  bool is_confirmed = false;  ///< points from before agree better with it than with the prediction
};

/// The features of a frame, and the inertial data before it.
struct FeatureView {
  struct Point {
    std::int64_t id = 0;
    Eigen::Vector2d bearing;
    double depth = 0.0;  ///< [m]: measured, or estimated so far; 0 = unknown
    bool is_static = true;
  };
  Timestamp t;                 ///< on the IMU clock
  Timestamp stamp;             ///< of the image
  Pose T_w_b;                  ///< estimated so far
  Eigen::Vector3d velocity_w;  ///< change by the specific force since the previous frame [m/s]
  Eigen::Vector3d rotation_b;  ///< since the previous frame [rad]
  std::vector<Point> points;   ///< sorted by id
};

/// The views of the last frames, and their motion by PnP: features of one frame with known depth, and their
/// bearings in another one. A depth that was not measured is that of the landmark, which depends on the
/// states of the window; in a wide space hardly any other feature is on a static object.
class FeatureViews {
 public:
  struct Options {
    double focal_px = 500.0;      ///< of the camera
    double min_interval_s = 0.0;  ///< between successive views; earlier frames are left out
    double history_s = 0.2;       ///< age of the oldest view
    bool uses_relabeled = false;  ///< motion of features that are labeled static in the earlier view alone
    double min_static_ratio = 0;  ///< of the tracked features, that must agree with a motion
    int min_agreeing = 0;         ///< features that must agree with a motion
  };
  explicit FeatureViews(const Options& options) : options_(options) {}

  /// Adds the newest frame of a window with an IMU.
  /// @return false if it is too early for another view
  bool add(const Window& window);

  /// Index of the newest view at least `seconds` before `t`.
  [[nodiscard]] std::optional<std::size_t> before(Timestamp t, double seconds) const;
  [[nodiscard]] std::size_t size() const { return views_.size(); }
  [[nodiscard]] const FeatureView& operator[](std::size_t i) const { return views_[i]; }

  /// The pose of the view `to` from the pose of an earlier view, with the covariance of the motion.
  /// @return nullopt if less than seven tenths of the features agree, or do not determine it
  [[nodiscard]] std::optional<VisualPose> pose_after(const VisualPose& before, std::size_t from,
                                                     std::size_t to, const Pose& T_b_c);

  void reset() { views_.clear(); }

 private:
  Options options_;
  std::vector<FeatureView> views_;
  std::vector<PointObservation> observations_;  ///< buffer of `pose_after`
};

}  // namespace stillpoint
