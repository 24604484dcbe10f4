// SPDX-License-Identifier: BSD-3-Clause
// The calibration that a window of the estimator starts with.
#include "core/backend/estimator.h"

namespace stillpoint {

bool Estimator::aligns_rotations() const {
  return backend_.initializer.align_rotations && uses_imu() && backend_.estimate_extrinsics &&
         has_metric_scale() && !window_.inertial && !rotation_alignment_;
}

/// Once the alignment is found, the window starts anew with it, at the same pose of the camera.
void Estimator::align_rotations() {
  if (window_.frames.empty()) {
    rotation_aligner_.reset();
    return;
  }
  const Pose T_w_c = newest_.T_w_b * window_.T_b_c;
  rotation_aligner_.add(newest_.t, T_w_c.q);
  rotation_alignment_ = rotation_aligner_.align(imu_);
  if (!rotation_alignment_) return;
  restart(window_.gravity_w);
  newest_.T_w_b = T_w_c * window_.T_b_c.inverse();
  newest_.gyro_bias = rotation_alignment_->gyro_bias;
  previous_ = newest_;
}

/// Without frames.
Window Estimator::calibrated_window() const {
  Window window = rig_window();
  if (!rotation_alignment_) return window;
  window.T_b_c.q = rotation_alignment_->q_b_c;
  window.time_offset_s = rotation_alignment_->time_offset_s;
  return window;
}

/// Without frames, with the calibration that the priors are about.
Window Estimator::rig_window() const {
  Window window;
  window.T_b_c = rig_.T_b_c;
  window.time_offset_s = rig_.time_offset_s;
  window.time_offset_model = backend_.time_offset_model;
  return window;
}

}  // namespace stillpoint
