// SPDX-License-Identifier: BSD-3-Clause
/// Start of a window: its first frame, the initialization of gravity, velocities and scale, and the restart
/// after a failure or with another calibration. Paper Sec. II (initialization).
#pragma once

#include <optional>

#include "core/backend/solvers/window_solver.h"
#include "core/backend/start/calibration.h"
#include "core/backend/start/rotation_alignment.h"
#include "core/backend/window/window.h"
#include "core/config/backend_config.h"
#include "core/config/imu_config.h"

namespace stillpoint {

/// With depth a window is metric from its first frame on and waits for its inertial initialization only.
/// Without depth it collects frames until structure from motion and the IMU determine the scale.
class WindowStart {
 public:
  /// @throws InputError if the IMU is enabled for a rig without one, or if keys of the configuration
  /// contradict each other: the scale is unobservable (depth is off and there is no IMU or no monocular
  /// initializer); a monocular initializer with depth; a depth scale that is to be estimated without depth
  /// residuals; estimated calibration that is to be compared with the rig without a covariance
  WindowStart(const BackendConfig& backend, const ImuConfig& imu, const Rig& rig);

  /// Adds the first frame and the priors that fix the gauge and the calibration.
  /// @param first  with its state
  /// @param window without frames
  void begin(WindowFrame first, const Calibration& calibration, const ImuBuffer& imu, Window& window) const;

  /// Initializes gravity, velocities, biases and without depth the scale, by `align_with_imu`, once a visual
  /// window is full or, with `InitializerKind::kInstant`, long enough.
  /// @param solver for the structure from motion without depth
  /// @return whether the window has become inertial
  [[nodiscard]] bool initialize(Window& window, WindowSolver& solver) const;

  /// An empty window in the same world.
  /// @param window    that is given up; an estimated gravity is kept with its covariance
  /// @param gravity_w before the solve that failed
  [[nodiscard]] static Window restarted(const Window& window, const Eigen::Vector3d& gravity_w,
                                        const Calibration& calibration);

  /// For each frame until the rotations are aligned: adds the rotation of the camera to the newest frame of
  /// the window, if it has one, and aligns all with the gyroscope.
  /// @param now stamp of the newest frame
  [[nodiscard]] std::optional<RotationAlignment> align_rotations(const Window& window, Timestamp now,
                                                                 ImuBuffer& imu);

 private:
  BackendConfig backend_;
  ImuConfig imu_;
  double focal_px_;
  CameraRotations camera_rotations_;
  RotationAligner rotation_aligner_;
};

/// Before a window is given up whose calibration was wrong: gravity was estimated with it, so that its
/// direction is uncertain, and a window that restarts is not inertial.
void forget_calibrated_gravity(Window& window);

}  // namespace stillpoint
