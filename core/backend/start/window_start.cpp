// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/window_start.h"

#include <utility>

#include "core/backend/start/initial_prior.h"
#include "core/backend/start/initializer.h"
#include "core/backend/start/monocular_structure.h"
#include "core/base/error.h"

namespace stillpoint {
namespace {

/// Variance of the direction of gravity that was estimated with a wrong calibration [rad^2].
constexpr double kUncertainGravity = 0.05 * 0.05;

void check_config(const BackendConfig& backend, const ImuConfig& imu, const Rig& rig) {
  if (imu.enabled && !rig.has_imu) {
    throw InputError("imu.enabled", "the sequence has no inertial data; run with --variant vo");
  }
  const bool monocular = backend.initializer.kind == InitializerKind::kMonocular;
  const bool no_depth = backend.depth.usage == DepthUsage::kOff;
  if (no_depth && !imu.enabled) {
    throw InputError("backend.depth.usage",
                     "\"off\" without an IMU makes the scale unobservable; use \"fixed\" or \"weighted\"");
  }
  if (no_depth && !monocular) {
    throw InputError("backend.depth.usage",
                     "\"off\" makes the scale unobservable; use \"fixed\" or \"weighted\", or "
                     "backend.initializer.kind = \"monocular\"");
  }
  if (monocular && !no_depth) {
    throw InputError("backend.initializer.kind",
                     "\"monocular\" requires backend.depth.usage = \"off\"; with depth use \"window\" or "
                     "\"instant\"");
  }
  if (backend.depth.estimate_scale && backend.depth.usage != DepthUsage::kWeighted) {
    throw InputError("backend.depth.estimate_scale", "requires backend.depth.usage = \"weighted\"");
  }
  const bool estimates = backend.depth.estimate_scale || backend.estimate_extrinsics;
  if (estimates && backend.calibration_agreement_probability > 0.0 && !backend.covariance) {
    throw InputError("backend.calibration_agreement_probability",
                     "requires backend.covariance = true; 0 estimates the calibration from the start");
  }
}

}  // namespace

WindowStart::WindowStart(const BackendConfig& backend, const ImuConfig& imu, const Rig& rig)
    : backend_(backend),
      imu_(imu),
      focal_px_(rig.camera.focal_px()),
      camera_rotations_(rig.camera.focal_px()),
      rotation_aligner_(backend, rig) {
  check_config(backend, imu, rig);
}

void WindowStart::begin(WindowFrame first, const Calibration& calibration, const ImuBuffer& imu,
                        Window& window) const {
  if (averages_imu(backend_)) average_imu_at_exposure(imu, first);
  window.frames.push_back(std::move(first));
  window.prior = initial_prior(window, backend_);
  window.calibration = calibration.prior();
}

bool WindowStart::initialize(Window& window, WindowSolver& solver) const {
  if (!imu_.enabled || window.inertial) return false;
  const double span = seconds_between(window.frames.front().state.t, window.frames.back().state.t);
  const bool instant = backend_.initializer.kind == InitializerKind::kInstant && window.newest() >= 4;
  const bool is_full = window.newest() == backend_.window_size;
  if (!is_full && !(instant && span >= backend_.initializer.min_span_s)) return false;
  std::optional<Window> visual = backend_.depth.usage != DepthUsage::kOff
                                     ? window
                                     : reconstruct_window(window, backend_, focal_px_, solver);
  if (!visual) return false;
  const std::optional<InertialAlignment> alignment =
      align_with_imu(*visual, imu_.gravity, backend_.initializer);
  if (!alignment) return false;
  const Pose anchor = window.frames.front().state.T_w_b;
  if (backend_.gravity == GravityModel::kEstimated) {
    if (!apply_alignment_to_frozen_world(*alignment, anchor, *visual)) return false;
  } else {
    apply_alignment(*alignment, anchor, *visual);
  }
  window = std::move(*visual);
  window.prior = initial_prior(window, backend_);
  return true;
}

Window WindowStart::restarted(const Window& window, const Eigen::Vector3d& gravity_w,
                              const Calibration& calibration) {
  Window fresh = calibration.calibrated_window();
  fresh.gravity_w = gravity_w;
  fresh.gravity_covariance =
      window.estimates_gravity() ? gravity_covariance(window.prior) : window.gravity_covariance;
  if (fresh.gravity_covariance && !fresh.gravity_covariance->allFinite()) fresh.gravity_covariance.reset();
  return fresh;
}

std::optional<RotationAlignment> WindowStart::align_rotations(const Window& window, Timestamp now,
                                                              ImuBuffer& imu) {
  if (!window.frames.empty()) {
    for (const CameraRotation& rotation : camera_rotations_.add(window)) rotation_aligner_.add(rotation);
  }
  return rotation_aligner_.align(now, imu);
}

void forget_calibrated_gravity(Window& window) {
  window.inertial = false;
  if (window.gravity_covariance) *window.gravity_covariance = kUncertainGravity * Eigen::Matrix2d::Identity();
}

}  // namespace stillpoint
