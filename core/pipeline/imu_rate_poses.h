// SPDX-License-Identifier: BSD-3-Clause
/// State at IMU rate, propagated from the newest estimate with all samples received so far, and the camera
/// pose at each sample, as known when the sample arrives (causal). Paper Sec. II: "the propagation of the IMU
/// is responsible for an IMU-rate pose estimation result".
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/backend/state_prediction.h"
#include "core/config/odometry_config.h"
#include "core/types/odometry_update.h"
#include "core/types/rig.h"
#include "core/types/trajectory.h"

namespace stillpoint {

class StatePredictor {
 public:
  /// @param max_gap_s time for which the newest sample is held
  explicit StatePredictor(double max_gap_s) : imu_(max_gap_s) {}

  void add_imu(const ImuSample& sample) { imu_.add(sample); }

  /// Sets the estimate after a frame.
  void set(const MotionState& motion, OdometryStatus status);

  /// As `Odometry::state`.
  [[nodiscard]] std::optional<NavState> state() const;
  /// As `Odometry::state_at`.
  [[nodiscard]] std::optional<NavState> state_at(Timestamp t);

 private:
  ImuBuffer imu_;
  MotionState motion_;
  bool valid_ = false;
};

/// Change of the predicted pose when a new estimate replaces the one that it was propagated from, at one IMU
/// sample.
struct PoseCorrection {
  double translation_m = 0.0;
  double rotation_deg = 0.0;
};

struct ImuRateOutput {
  Trajectory trajectory;  ///< T_w_c, frame "camera", on the clock of the frames
  std::vector<PoseCorrection> corrections;
  std::vector<double> ages_ms;  ///< of each pose: time since the exposure of the newest frame in the estimate
};

/// Propagates the newest available estimate with all samples up to each sample:
///
///   T_w_b(s) = propagate(x_k, samples in (t_k + d_k, s]),   k = argmax { t_k : available_k <= s }
///
/// s: time of a sample; x_k, d_k: state and time offset estimated at frame k; t_k: its exposure; available_k:
/// `FrameReport::available`. While inertial data is not used, the pose continues at the velocity between the
/// last two estimates. It has the stamp s - d_k. Samples before the first estimate, after the
/// last one, and while the odometry is lost have no pose.
class ImuRatePoses {
 public:
  /// @param samples ascending; must outlive this object
  ImuRatePoses(const OdometryConfig& config, std::span<const ImuSample> samples);

  /// Adds the poses of the samples before `available`, by the estimates so far, then the estimate.
  /// @param update in the order of the frames
  /// @param available time on the IMU clock
  void add(const OdometryUpdate& update, Timestamp available);

  [[nodiscard]] ImuRateOutput take() { return std::move(output_); }

 private:
  void propagate_until(Timestamp end);
  void record_correction(const Pose& predicted_T_w_c, Timestamp sample);

  double gravity_;
  std::span<const ImuSample> samples_;
  std::size_t next_ = 0;  ///< index of the first sample without a pose
  StatePredictor predictor_;
  MotionState motion_;  ///< of the newest estimate
  int segment_ = 0;     ///< same
  ImuRateOutput output_;
};

}  // namespace stillpoint
