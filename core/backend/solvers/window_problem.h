// SPDX-License-Identifier: BSD-3-Clause
/// Parameter blocks and residuals of a window, shared by solve and marginalization.
#pragma once

#include <memory>
#include <vector>

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include "core/backend/factors/reprojection_rows.h"
#include "core/backend/window/observation_model.h"
#include "core/backend/window/window.h"
#include "core/config/backend_config.h"

namespace stillpoint {

/// Copies of the window's states in the solver's layout: T_w_b of each frame as (p, q xyzw), then each
/// frame's v, gyro bias and accel bias, then T_b_c, the time offset, and the inverse depth of each landmark,
/// usable or not.
///
/// A single array: Ceres orders blocks by address, so with separate arrays the elimination order, and thereby
/// the rounding of the result, would depend on the allocator.
class ParameterBlocks {
 public:
  ParameterBlocks() = default;
  explicit ParameterBlocks(const Window& window) { assign(window); }

  /// Copies the states of a window; allocates only if it is larger than all windows before.
  void assign(const Window& window);
  [[nodiscard]] double* pose(std::size_t frame) { return &values_[7 * frame]; }
  [[nodiscard]] double* speed_bias(std::size_t frame) { return &values_[7 * frames_ + 9 * frame]; }
  [[nodiscard]] double* extrinsics() { return &values_[16 * frames_]; }
  [[nodiscard]] double* time_offset() { return &values_[16 * frames_ + 7]; }
  [[nodiscard]] double* inverse_depth(std::size_t landmark) { return &values_[16 * frames_ + 8 + landmark]; }

 private:
  std::size_t frames_ = 0;
  std::vector<double> values_;
};

/// Writes the values of the blocks back to the states of the window.
void unpack(ParameterBlocks& blocks, Window& window);

/// One block of the window's states; `frame` is -1 for calibration.
struct BlockRef {
  BlockKind kind = BlockKind::kPose;
  int frame = -1;
};
[[nodiscard]] double* block_address(ParameterBlocks& blocks, BlockRef block);

/// A residual and its parameter blocks: states first, then the inverse depth of a landmark (index, or -1 for
/// none).
struct Residual {
  std::unique_ptr<ceres::CostFunction> cost;
  ceres::LossFunction* loss = nullptr;  ///< not owned; null = squared loss
  std::vector<BlockRef> states;
  int landmark = -1;
};

/// Standard deviations of the visual residuals.
[[nodiscard]] ReprojectionNoise reprojection_noise(const BackendConfig& config, double focal_px);

/// Whether a landmark's inverse depth is constant at its measured value (as in the published system).
[[nodiscard]] bool has_constant_depth(const Landmark& landmark, const BackendConfig& config);

/// Whether the measured depth of an observation is used as a residual.
[[nodiscard]] bool uses_depth(const Observation& observation, const BackendConfig& config);

/// Which calibration blocks are variable in the solve.
struct VariableCalibration {
  bool extrinsics = false;
  bool time_offset = false;
};
[[nodiscard]] VariableCalibration variable_calibration(const Window& window, const BackendConfig& config);

/// Addresses of the parameter blocks of a residual, in the order of its cost function.
[[nodiscard]] std::vector<double*> parameter_addresses(const Residual& residual, ParameterBlocks& blocks);

/// Builds the residuals of a window. The builder and the window must outlive the residuals.
class ResidualBuilder {
 public:
  ResidualBuilder(const Window& window, const BackendConfig& config, double focal_px);

  /// All residuals of one usable landmark: host depth, and one per further observation.
  void add_landmark(int index, std::vector<Residual>& out);
  /// IMU factor between frame - 1 and frame, if there is one.
  void add_imu(int frame, std::vector<Residual>& out);
  /// Marginalization prior.
  void add_prior(std::vector<Residual>& out);
  /// Prior on extrinsics and time offset from the calibrated values.
  void add_calibration(std::vector<Residual>& out);

 private:
  const Window& window_;
  const BackendConfig& config_;
  ObservationModel observation_model_;
  ReprojectionNoise noise_;
  std::unique_ptr<ceres::LossFunction> loss_;
};

}  // namespace stillpoint
