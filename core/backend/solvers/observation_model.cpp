// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/observation_model.h"

namespace stillpoint {
namespace {

/// A bearing at the time of the middle row, where the state is defined.
TimedBearing without_readout(const TimedBearing& timed, double readout_offset_s) {
  return {.bearing = timed.bearing - readout_offset_s * timed.velocity, .seen = timed.seen};
}

}  // namespace

void ObservationModel::read(const Window& window) {
  inertial_ = window.inertial;
  at_exposure_ = window.time_offset_model == TimeOffsetModel::kInertial;
  cameras_.resize(window.frames.size());
  const Eigen::Matrix3d R_c_b = window.T_b_c.R().transpose();
  const Eigen::Vector3d lever_c = R_c_b * window.T_b_c.p;
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    const WindowFrame& frame = window.frames[i];
    const Pose T_w_c = frame.state.T_w_b * window.T_b_c;
    const Eigen::Matrix3d R_c_w = T_w_c.R().transpose();
    const Eigen::Vector3d rate_c = R_c_b * (frame.gyro_b - frame.state.gyro_bias);
    cameras_[i] = {.R_c_w = R_c_w,
                   .p_w = T_w_c.p,
                   .velocity_c = -(R_c_w * frame.state.v_w) - rate_c.cross(lever_c),
                   .rate_c = rate_c,
                   .time_offset_s = frame.time_offset_s};
  }
}

/// Finite differences of tracked bearings share their noise with the residual and bias the time offset; with
/// an IMU the velocity is computed from the state instead.
TimedBearing ObservationModel::at(const Landmark& landmark, int frame,
                                  const Eigen::Vector3d& position_w) const {
  const Observation& observation = landmark.observation_in(frame);
  if (at_exposure_ && observation.readout_offset_s == 0.0)
    return {.bearing = observation.bearing, .seen = observation.seen};
  const Camera& camera = cameras_[static_cast<std::size_t>(frame)];
  TimedBearing timed{.bearing = observation.bearing,
                     .seen = observation.seen,
                     .velocity = observation.velocity,
                     .exposure_s = observation.readout_offset_s - camera.time_offset_s};
  if (!inertial_) return at_exposure_ ? without_readout(timed, observation.readout_offset_s) : timed;
  const Eigen::Vector3d p_c = camera.R_c_w * (position_w - camera.p_w);
  const Eigen::Vector3d velocity_c = camera.velocity_c - camera.rate_c.cross(p_c);
  timed.velocity = (velocity_c.head<2>() - p_c.head<2>() / p_c.z() * velocity_c.z()) / p_c.z();
  return at_exposure_ ? without_readout(timed, observation.readout_offset_s) : timed;
}

Eigen::Vector3d ObservationModel::position(const Landmark& landmark) const {
  const Camera& host = cameras_[static_cast<std::size_t>(landmark.host)];
  const Eigen::Vector3d p_c = landmark.observations.front().bearing.homogeneous() / landmark.inverse_depth;
  return host.R_c_w.transpose() * p_c + host.p_w;
}

}  // namespace stillpoint
