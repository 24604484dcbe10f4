// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/reference/normal_equations.h"

#include <cmath>

#include "core/base/error.h"

namespace stillpoint {
namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A residual with its Jacobians at the current states, weighted by its robust loss.
struct Linearized {
  Eigen::VectorXd residual;
  std::vector<RowMajorMatrix> jacobians;  ///< in block order, tangent columns only
};

Linearized linearize(const Residual& source, const ParameterBlocks& blocks, double information) {
  const std::vector<const double*> addresses = parameter_addresses(source, blocks);
  const std::vector<int>& sizes = source.cost->parameter_block_sizes();
  Linearized out{Eigen::VectorXd(source.cost->num_residuals()), {}};
  std::vector<double*> pointers;
  for (const int size : sizes) out.jacobians.emplace_back(source.cost->num_residuals(), size);
  for (RowMajorMatrix& jacobian : out.jacobians) pointers.push_back(jacobian.data());
  STILLPOINT_CHECK(source.cost->Evaluate(addresses.data(), out.residual.data(), pointers.data()));

  double weight = 1.0;
  if (source.loss != nullptr) {
    double rho[3];
    source.loss->Evaluate(out.residual.squaredNorm(), rho);
    weight = std::sqrt(rho[1]);
  }
  weight *= std::sqrt(information);
  out.residual *= weight;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const int tangent = i < source.states.size() ? local_size(source.states[i].kind) : 1;
    out.jacobians[i] = RowMajorMatrix(weight * out.jacobians[i].leftCols(tangent));
  }
  return out;
}

}  // namespace

NormalEquations::NormalEquations(int frames)
    : layout(frames),
      H(Eigen::MatrixXd::Zero(layout.size(), layout.size())),
      b(Eigen::VectorXd::Zero(layout.size())) {}

void NormalEquations::add(const std::vector<Residual>& group, const ParameterBlocks& blocks, bool fixed,
                          double information) {
  Eigen::VectorXd landmark_column = Eigen::VectorXd::Zero(layout.size());
  double landmark_information = 0.0;
  double landmark_gradient = 0.0;
  for (const Residual& source : group) {
    const Linearized linear = linearize(source, blocks, information);
    const bool has_landmark = source.landmark >= 0;
    const RowMajorMatrix* J_landmark = has_landmark ? &linear.jacobians.back() : nullptr;
    for (std::size_t i = 0; i < source.states.size(); ++i) {
      const RowMajorMatrix& J_i = linear.jacobians[i];
      const int column_i = layout.column(source.states[i]);
      b.segment(column_i, J_i.cols()) += J_i.transpose() * linear.residual;
      if (has_landmark) landmark_column.segment(column_i, J_i.cols()) += J_i.transpose() * J_landmark->col(0);
      for (std::size_t j = 0; j < source.states.size(); ++j) {
        const RowMajorMatrix& J_j = linear.jacobians[j];
        H.block(column_i, layout.column(source.states[j]), J_i.cols(), J_j.cols()) += J_i.transpose() * J_j;
      }
    }
    if (has_landmark) {
      landmark_information += J_landmark->squaredNorm();
      landmark_gradient += J_landmark->col(0).dot(linear.residual);
    }
  }
  if (fixed || landmark_information <= 0.0) return;
  H.noalias() -= landmark_column * landmark_column.transpose() / landmark_information;
  b.noalias() -= landmark_column * (landmark_gradient / landmark_information);
}

NormalEquations linearize_all(const Window& window, const BackendConfig& config, double focal_px,
                              const ParameterBlocks& blocks) {
  NormalEquations equations(static_cast<int>(window.frames.size()));
  ResidualBuilder builder(window, config, focal_px);
  builder.add_states();
  equations.add(builder.residuals(), blocks, false);
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    if (!is_usable(window.landmarks[i])) continue;
    builder.clear();
    builder.add_landmark(static_cast<int>(i));
    equations.add(builder.residuals(), blocks, has_constant_depth(window.landmarks[i], config));
  }
  return equations;
}

}  // namespace stillpoint
