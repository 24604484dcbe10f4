// SPDX-License-Identifier: BSD-3-Clause
/// Residuals of a window as Ceres cost functions, for solve and marginalization by Ceres.
#pragma once

#include <memory>
#include <vector>

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include "core/backend/solvers/observation_model.h"
#include "core/backend/solvers/window_problem.h"

namespace stillpoint {

/// A residual and its parameter blocks: states first, then the inverse depth of a landmark (index, or -1 for
/// none).
struct Residual {
  std::unique_ptr<ceres::CostFunction> cost;
  ceres::LossFunction* loss = nullptr;  ///< not owned; null = squared loss
  std::vector<BlockRef> states;
  int landmark = -1;
};

/// Addresses of the parameter blocks of a residual, in the order of its cost function.
template <class Blocks>  // ParameterBlocks or const ParameterBlocks
[[nodiscard]] auto parameter_addresses(const Residual& residual, Blocks& blocks) {
  std::vector<decltype(blocks.at({}))> addresses;
  for (const BlockRef state : residual.states) addresses.push_back(blocks.at(state));
  if (residual.landmark >= 0)
    addresses.push_back(blocks.inverse_depth(static_cast<std::size_t>(residual.landmark)));
  return addresses;
}

/// Builds the residuals of a window, in the order of the calls. The window must outlive the builder.
class ResidualBuilder {
 public:
  ResidualBuilder(const Window& window, const BackendConfig& config, double focal_px);

  /// All residuals of the states alone: priors, and IMU factors between all frames.
  void add_states();
  /// All residuals of one usable landmark: host depth, and one per further observation.
  void add_landmark(int index);
  /// IMU factor between frame - 1 and frame, if there is one.
  void add_imu(int frame);
  /// Marginalization prior.
  void add_prior();

  /// Residuals added so far; they refer to the builder and the window.
  [[nodiscard]] const std::vector<Residual>& residuals() const { return residuals_; }
  /// Removes the residuals added so far.
  void clear() { residuals_.clear(); }

 private:
  [[nodiscard]] const double* first_estimate(BlockRef block) const;
  [[nodiscard]] ceres::LossFunction* scaled_loss(ceres::LossFunction* loss, double information);

  const Window& window_;
  const BackendConfig& config_;
  ObservationModel observation_model_;
  ReprojectionNoise noise_;
  std::unique_ptr<ceres::LossFunction> loss_;
  std::vector<std::unique_ptr<ceres::LossFunction>> scaled_losses_;
  std::vector<Residual> residuals_;
};

}  // namespace stillpoint
