// SPDX-License-Identifier: BSD-3-Clause
/// Nonlinear least squares over the window: the state optimization of Paper Sec. II.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/backend/solvers/window_problem.h"
#include "core/backend/window/window.h"
#include "core/config/backend_config.h"
#include "core/geometry/covariance.h"
#include "core/types/nav_state.h"

namespace stillpoint {

struct SolveReport {
  int iterations = 0;
  int landmarks = 0;        ///< used in the solve
  int depth_landmarks = 0;  ///< of those, with measured depth
  double initial_cost = 0.0;
  double final_cost = 0.0;
  bool usable = true;  ///< false: the solver failed and the window is unchanged
};

struct WindowCovariance {
  StateCovariance newest;
  RigStep rig_step;
  /// Of the motion T_b0_b1 from the oldest frame to the next one; absent unless requested.
  std::optional<UncertainPose> oldest_motion;
};

/// Extension point for solvers. An instance is reused for its buffers only: results depend on nothing but the
/// arguments. All solvers minimize the same cost and differ in their rounding errors and their speed.
class WindowSolver {
 public:
  virtual ~WindowSolver() = default;

  /// Minimizes over all states x of the window, with a limit on iterations but not on time (deterministic),
  ///
  ///   1/2 ( |r_prior(x)|^2 + |r_calibration(x)|^2 + sum_k |r_imu,k(x)|^2 + sum_l r_depth,l(x)^2
  ///         + sum_(l,j) rho(|r_visual,lj(x)|^2) ),    rho(s) = c^2 log(1 + s / c^2)   (Cauchy)
  ///
  /// with the whitened residuals of LinearPrior, ImuFactor, HostDepthFactor and ReprojectionFactor, and
  /// c = `cauchy_scale`. Landmarks at infinity or behind their host lose their depth.
  /// @param window its prior fixes the gauge, so it must not be empty
  /// @param config `config.solver` is ignored
  /// @param focal_px focal length of the camera, converts pixels to bearings
  [[nodiscard]] SolveReport solve(Window& window, const BackendConfig& config, double focal_px);

  /// Prior of the remaining states after marginalizing the oldest frame and the landmarks hosted in it.
  ///
  /// All residuals that involve these variables (the current prior, the IMU factor to frame 1, the
  /// reprojection residuals of the landmarks, the latter weighted by their robust loss) are linearized once
  /// at the current estimate x0. With H = sum J_k^T J_k and b = sum J_k^T r_k, split into the marginalized
  /// states m (frame 0; its landmarks are eliminated first, in the same way) and the remaining states r,
  ///
  ///   [ H_mm  H_mr ] [dx_m]     [ b_m ]
  ///   [ H_rm  H_rr ] [dx_r] = - [ b_r ],
  ///
  /// minimizing over dx_m leaves the Schur complement
  ///
  ///   H* = H_rr - H_rm H_mm^-1 H_mr,    b* = b_r - H_rm H_mm^-1 b_m.
  ///
  /// A square root J^T J = H*, J^T r0 = b* gives the residual of LinearPrior, r(x) = r0 + J (x [-] x0); x0 is
  /// stored as the linearization point of its blocks. See the solvers for how it is computed.
  ///
  /// Qin et al. 2018, Sec. VI. Frame indices of the result are those after the slide (one less). The result
  /// is empty if no residual connects frame 0 to the others.
  /// @param recycled a prior that is no longer needed; its memory is reused
  [[nodiscard]] virtual LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config,
                                                       double focal_px, LinearPrior recycled) = 0;

  /// Covariance of the newest state: with H of all residuals of `solve`, linearized at the states of the
  /// window, the blocks of H^-1 of that state and of the global states. That of the motion from the oldest
  /// frame to the next one follows from the blocks of H^-1 of both poses, in which the error of the whole
  /// window relative to the gauge cancels, see `relative_pose`. Absent if H is singular, that is, if the
  /// residuals leave a state unconstrained.
  /// @param oldest_motion whether the second one is requested; at least two frames
  [[nodiscard]] virtual std::optional<WindowCovariance> covariance(const Window& window,
                                                                   const BackendConfig& config,
                                                                   double focal_px, bool oldest_motion) = 0;

 private:
  /// `solve` without the reset of lost depths.
  [[nodiscard]] virtual SolveReport minimize(Window& window, const BackendConfig& config,
                                             double focal_px) = 0;
};

// The blocks whose covariance is reported with each frame, and their place in WindowCovariance.

inline constexpr int kNewestColumns = kFrameColumns + kGlobalColumns;
using NewestMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kNewestColumns, kNewestColumns>;

/// Pose of the newest frame, its velocity and biases if there are any, and the variable global states.
/// @param recycled storage for the result; its content is ignored
[[nodiscard]] std::vector<BlockRef> newest_blocks(const Window& window, const BackendConfig& config,
                                                  std::vector<BlockRef> recycled = {});

/// @param covariance joint covariance of `blocks`, as `newest_blocks` gives them, in their order
[[nodiscard]] StateCovariance state_covariance(std::span<const BlockRef> blocks,
                                               const NewestMatrix& covariance);

using NewestVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kNewestColumns, 1>;

/// @param blocks as in `state_covariance`
/// @param step Gauss-Newton step of the blocks, all of them variable
[[nodiscard]] RigStep rig_step(std::span<const BlockRef> blocks, const NewestVector& step);

inline constexpr std::array<BlockRef, 2> kOldestPoses = {BlockRef{BlockKind::kPose, 0},
                                                         BlockRef{BlockKind::kPose, 1}};

/// T_b0_b1. @param covariance joint covariance of `kOldestPoses`
[[nodiscard]] UncertainPose oldest_motion_of(const Window& window, const NewestMatrix& covariance);

}  // namespace stillpoint
