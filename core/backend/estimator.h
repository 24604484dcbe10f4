// SPDX-License-Identifier: BSD-3-Clause
/// The state optimisation: tracked features and inertial samples in, a pose per picture out. Paper Sec. II.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/backend/backend_config.h"
#include "core/backend/camera_pose.h"
#include "core/backend/marginalization.h"
#include "core/backend/pixel_noise.h"
#include "core/backend/schur/schur_solver.h"
#include "core/backend/state_prediction.h"
#include "core/backend/window.h"
#include "core/backend/window_solver.h"
#include "core/imu/imu_buffer.h"
#include "core/imu/imu_config.h"
#include "core/types/feature_verdict.h"
#include "core/types/odometry_update.h"
#include "core/types/rig.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// A sliding window over the last pictures. It starts as visual odometry of metric scale; with an IMU it
/// turns inertial as soon as gravity and speeds are known, and reports poses from then on. Without depth
/// there is no visual odometry before: it collects a window until structure from motion and the IMU give its
/// scale.
class Estimator {
 public:
  /// @throws InputError if inertial data are asked of a rig without an IMU, or nothing gives the scale: depth
  /// is off and there is no IMU or no monocular initialiser
  Estimator(const BackendConfig& backend, const ImuConfig& imu, const Rig& rig, int seed);

  /// Samples in order of time; those up to a picture's exposure come before the picture.
  void add_imu(const ImuSample& sample) { imu_.add(sample); }

  /// Takes a picture into the window, where it was most likely taken.
  ///
  /// A picture is `add`ed, its movers are marked, it is `refine`d, what shows itself as a mover by the
  /// refined poses is marked, and `finish` closes it. Each step adds its part to the picture's update.
  /// @param frame features by rising id
  void add(const TrackedFrame& frame, OdometryUpdate& update);

  /// Keeps what moves out of all that follows, and takes what was cleared back in.
  /// @param verdicts by rising id; landmarks without one stay as they are
  void mark_dynamic(std::span<const FeatureVerdict> verdicts);

  /// Finds the picture's pose and refines the window.
  /// @return false if the estimate is lost: the window is empty, the next picture begins anew
  [[nodiscard]] bool refine(OdometryUpdate& update);

  /// Makes room for the next picture and reports the state.
  void finish(OdometryUpdate& update);

  /// Reports the pose at a picture that does not enter the window, propagated from the newest state.
  void predict(std::int64_t frame_id, Timestamp t, OdometryUpdate& update);

  /// What the tracker needs to predict the next picture.
  [[nodiscard]] MotionKnowledge knowledge() const;

  [[nodiscard]] const ImuHealth& imu_health() const { return imu_.health(); }
  [[nodiscard]] const Window& window() const { return window_; }

 private:
  [[nodiscard]] bool uses_imu() const { return imu_config_.enabled; }
  [[nodiscard]] bool knows_scale() const {
    return window_.inertial || backend_.depth.usage != DepthUsage::kOff;
  }
  [[nodiscard]] bool is_full() const { return window_.newest() == backend_.window_size; }
  void push_frame(const TrackedFrame& frame);
  [[nodiscard]] bool locate_newest();
  void refresh_preintegrations();
  void try_to_become_inertial();
  [[nodiscard]] bool has_failed(const NavState& before) const;
  void restart();
  void slide(bool keyframe);
  [[nodiscard]] OdometryStatus status() const;
  void report(const NavState& state, OdometryUpdate& update) const;

  BackendConfig backend_;
  ImuConfig imu_config_;
  Rig rig_;
  std::uint32_t seed_;
  ImuBuffer imu_;
  SchurSolver solver_;              ///< its memory only, whoever solves
  FrameMarginalizer marginalizer_;  ///< likewise
  Window window_;
  std::vector<PointSighting> sightings_;  ///< kept for its memory
  MisfitMeter misfit_;
  PixelNoise pixel_noise_;
  NavState newest_;    ///< last state handed out
  NavState previous_;  ///< the one before: constant velocity where there is no IMU
  bool located_ = true;
  bool keyframe_ = true;  ///< whether the picture before the newest stays
  bool begun_ = false;    ///< a picture has come
};

}  // namespace stillpoint
