// SPDX-License-Identifier: BSD-3-Clause
/// The window as parameter blocks and residuals: what the solve and the marginalisation share.
#pragma once

#include <memory>
#include <vector>

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include "core/backend/backend_config.h"
#include "core/backend/factors/reprojection_rows.h"
#include "core/backend/observation_model.h"
#include "core/backend/window.h"

namespace stillpoint {

/// Copies of the window's states in the solver's layout: T_w_b of each frame as (p, q xyzw), then each
/// frame's v, gyro bias and accel bias, then T_b_c, the time offset, and the inverse depth of each landmark,
/// usable or not.
///
/// One array on purpose: Ceres orders blocks by address, so separate arrays would make the order of
/// elimination, and with it the last bits of the result, a matter of the allocator's mood.
class ParameterBlocks {
 public:
  ParameterBlocks() = default;
  explicit ParameterBlocks(const Window& window) { assign(window); }

  /// Takes over the states of a window; no allocation once one as large has been held.
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

void unpack(ParameterBlocks& blocks, Window& window);

/// One block of the window's states; `frame` is -1 for calibration.
struct BlockRef {
  BlockKind kind = BlockKind::kPose;
  int frame = -1;
};
[[nodiscard]] double* block_address(ParameterBlocks& blocks, BlockRef block);

/// A residual and the blocks it reads: states first, then the inverse depth of a landmark (an index, or -1
/// for none).
struct Residual {
  std::unique_ptr<ceres::CostFunction> cost;
  ceres::LossFunction* loss = nullptr;  ///< not owned; null = squared
  std::vector<BlockRef> states;
  int landmark = -1;
};

/// Standard deviations of the residuals of landmarks.
[[nodiscard]] ReprojectionNoise reprojection_noise(const BackendConfig& config, double focal_px);

/// Whether a landmark's depth is held where it was measured (the published system's choice).
[[nodiscard]] bool is_held(const Landmark& landmark, const BackendConfig& config);

/// Whether a measured depth is a residual.
[[nodiscard]] bool uses_depth(const Observation& observation, const BackendConfig& config);

/// Which of the calibration the solve may move.
struct FreeCalibration {
  bool extrinsics = false;
  bool time_offset = false;
};
[[nodiscard]] FreeCalibration free_calibration(const Window& window, const BackendConfig& config);

/// The addresses of all blocks of a residual in the order its cost function reads them.
[[nodiscard]] std::vector<double*> parameter_addresses(const Residual& residual, ParameterBlocks& blocks);

/// Makes the residuals of a window; both it and the window outlive what is made.
class ResidualBuilder {
 public:
  ResidualBuilder(const Window& window, const BackendConfig& config, double focal_px);

  /// All residuals of one usable landmark: its own depth, and each frame that saw it.
  void add_landmark(int index, std::vector<Residual>& out);
  /// The IMU between frame - 1 and frame; nothing where it is absent.
  void add_imu(int frame, std::vector<Residual>& out);
  /// What gone frames said.
  void add_prior(std::vector<Residual>& out);
  /// What the rig says, where the estimate may say otherwise.
  void add_calibration(std::vector<Residual>& out);

 private:
  const Window& window_;
  const BackendConfig& config_;
  ObservationModel observations_;
  ReprojectionNoise noise_;
  std::unique_ptr<ceres::LossFunction> loss_;
};

}  // namespace stillpoint
