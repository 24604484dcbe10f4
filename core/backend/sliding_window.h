// SPDX-License-Identifier: BSD-3-Clause
/// The sliding window of the state optimization: frames enter it, it is optimized, and frames leave it into
/// the prior. Paper Sec. II; Qin et al. 2018, Sec. VI.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/backend/solvers/marginalization.h"
#include "core/backend/solvers/window_solver.h"
#include "core/backend/start/calibration.h"
#include "core/backend/vision/camera_pose.h"
#include "core/backend/window/pixel_noise.h"
#include "core/backend/window/window.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// Creates the solver selected by `BackendConfig::solver`: SchurSolver, or its reference, CeresSolver.
[[nodiscard]] std::unique_ptr<WindowSolver> make_window_solver(WindowSolverKind kind);

/// Excludes dynamic landmarks from the estimate and re-admits cleared ones.
/// @param labels sorted by id; landmarks without a label are unchanged
void mark_dynamic(std::span<const DynamicLabel> labels, Window& window);

/// Inertial data between the newest frame and the next one.
struct InertialData {
  const std::vector<ImuSample>& samples;  ///< fewer than two: missing
  Timestamp begin, end;                   ///< on the IMU clock
  ImuNoise noise;
  bool is_reliable = true;
};

/// Owns the states (`Window`), their solver, and the noise of the features. Each frame goes through `append`,
/// `choose_keyframe`, `localize_newest`, `solve` and `slide`, in this order.
class SlidingWindow {
 public:
  /// @param seed of the sampling of features when a pose is sought by vision alone
  SlidingWindow(const BackendConfig& config, const Rig& rig, int seed, Window fresh);

  [[nodiscard]] const Window& states() const { return window_; }
  [[nodiscard]] Window& states() { return window_; }
  [[nodiscard]] WindowSolver& solver() { return *solver_; }
  [[nodiscard]] bool empty() const { return window_.frames.empty(); }
  /// Without the newest frame, `window_size` frames.
  [[nodiscard]] bool is_full() const { return window_.newest() == config_.window_size; }
  [[nodiscard]] bool has_metric_scale() const {
    return window_.inertial || config_.depth.usage != DepthUsage::kOff;
  }

  /// Replaces all states; the noise of the features is the nominal one again.
  void restart(Window fresh);

  /// Integrates the data up to `next`. Missing samples of an inertial window are replaced by those of a
  /// constant velocity.
  /// @param imu the buffer that the data is from
  void preintegrate(const InertialData& data, const ImuBuffer& imu, WindowFrame& next);
  /// Appends a frame with its predicted state.
  void append(WindowFrame next) { window_.frames.push_back(std::move(next)); }
  /// Adds the features of the newest frame. @param frame features sorted by id
  void add_features(const TrackedFrame& frame);
  /// Removes the newest frame, which could not be located.
  void discard_newest();

  /// Decides whether the second-newest frame stays in the window.
  void choose_keyframe();
  [[nodiscard]] bool keyframe() const { return keyframe_; }

  /// Without inertial prediction: estimates the newest camera pose from known points (PnP).
  /// @return whether inertial data or vision located the newest frame
  [[nodiscard]] bool localize_newest();

  /// Depths of new landmarks, and preintegrations whose biases have changed much.
  void prepare_solve();

  struct Solution {
    SolveReport report;
    CalibrationAtBound at_bound;
    std::optional<WindowCovariance> covariance;  ///< if it was requested and is known
  };
  /// Optimizes all states, and adapts the noise of the features to what remains.
  /// @param calibration whose bounds limit that of the window
  [[nodiscard]] Solution solve(const Calibration& calibration);

  /// After `solve`, if the oldest frame leaves the window in `slide`: its motion to the next frame, with its
  /// covariance; absent unless covariances are computed.
  [[nodiscard]] const std::optional<UncertainPose>& oldest_motion() const { return oldest_motion_; }

  /// Solves in succession that failed.
  [[nodiscard]] int unusable_solves() const { return unusable_solves_; }

  /// Covariance at the present states. @param oldest_motion see `WindowSolver::covariance`
  [[nodiscard]] std::optional<WindowCovariance> covariance(bool oldest_motion);

  /// If the window is full, a frame leaves it: the oldest one (marginalization), or without a keyframe the
  /// second-newest one.
  void slide();

  /// Standard deviation of a reprojection residual [normalized image plane].
  [[nodiscard]] double residual_sigma() const;
  /// Same of its change between successive frames, see `PixelNoise::white_px`.
  [[nodiscard]] double white_sigma() const;
  /// The newest features are not where they were predicted, see `PixelNoise`.
  void expect_errors() { pixel_noise_.expect_errors(); }

 private:
  BackendConfig config_;
  Rig rig_;
  std::uint32_t seed_;
  std::unique_ptr<WindowSolver> solver_;
  Window window_;
  bool keyframe_ = true;  ///< whether the second-newest frame stays in the window
  int unusable_solves_ = 0;
  std::optional<UncertainPose> oldest_motion_;
  ReprojectionErrorMonitor error_monitor_;
  PixelNoise pixel_noise_;
  // Members only to reuse the memory.
  FrameMarginalizer marginalizer_;
  LinearPrior discarded_prior_;
  std::vector<PointObservation> known_points_;
};

}  // namespace stillpoint
