// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/marginalization.h"

#include <utility>

#include <Eigen/Eigenvalues>

#include "core/base/error.h"

namespace stillpoint {
namespace {

/// Pivots below this ratio of the largest entry of the prior are rounding errors: on a rendered sequence
/// those are below 1e-13, and pivots of constraints above 1e-6.
constexpr double kPivotTolerance = 1e-9;

/// Eigenvalues below this ratio of the largest are treated as zero.
constexpr double kRankTolerance = 1e-12;

Eigen::MatrixXd select(const Eigen::MatrixXd& matrix, const std::vector<int>& rows,
                       const std::vector<int>& columns) {
  return matrix(rows, columns);
}

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  const double floor = kRankTolerance * solver.eigenvalues().cwiseAbs().maxCoeff();
  const Eigen::VectorXd inverse =
      (solver.eigenvalues().array() > floor).select(solver.eigenvalues().array().inverse(), 0.0);
  return solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace

/// Splits blocks and columns of the prior into those of the frame and the others.
void FrameMarginalizer::split(int frame, const LinearPrior& prior) {
  const Eigen::Index rows = prior.jacobian.rows();
  int marginalized = 0;
  for (const PriorBlock& block : prior.blocks)
    marginalized += block.frame == frame ? local_size(block.kind) : 0;
  STILLPOINT_CHECK(rows <= kMaxRows && marginalized <= kFrameColumns);
  marginalized_columns_.resize(rows, marginalized);
  remaining_columns_.resize(rows, prior.jacobian.cols() - marginalized + 1);
  result_.blocks.clear();
  int from = 0, to_marginalized = 0, to_remaining = 0;
  for (const PriorBlock& block : prior.blocks) {
    const int size = local_size(block.kind);
    if (block.frame == frame) {
      marginalized_columns_.middleCols(to_marginalized, size) = prior.jacobian.middleCols(from, size);
      to_marginalized += size;
    } else {
      remaining_columns_.middleCols(to_remaining, size) = prior.jacobian.middleCols(from, size);
      to_remaining += size;
      result_.blocks.push_back(block);
      if (block.frame > frame) --result_.blocks.back().frame;
    }
    from += size;
  }
  remaining_columns_.col(to_remaining) = prior.residual;
}

LinearPrior FrameMarginalizer::remove(int frame, LinearPrior prior) {
  split(frame, prior);
  Eigen::Index rank = 0;
  if (marginalized_columns_.cols() > 0) {
    // After applying Q^T only the first `rank` rows depend on the marginalized columns.
    qr_.compute(marginalized_columns_);
    Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kMaxRows + 1> workspace;
    Eigen::Map<Eigen::MatrixXd>& rotated = remaining_columns_;
    qr_.householderQ().adjoint().applyThisOnTheLeft(rotated, workspace);
    const double floor = kPivotTolerance * prior.jacobian.cwiseAbs().maxCoeff();
    rank = (qr_.matrixQR().diagonal().array().abs() > floor).count();
  }
  const Eigen::Index rows = remaining_columns_.rows() - rank;
  result_.jacobian = remaining_columns_.bottomLeftCorner(rows, remaining_columns_.cols() - 1);
  result_.residual = remaining_columns_.col(remaining_columns_.cols() - 1).tail(rows);
  std::swap(prior, result_);
  return prior;
}

SquareRoot eliminate(const Eigen::MatrixXd& H, const Eigen::VectorXd& b, const std::vector<int>& marginalized,
                     const std::vector<int>& remaining) {
  const Eigen::MatrixXd H_rm = select(H, remaining, marginalized);
  const Eigen::MatrixXd gain = H_rm * pseudo_inverse(select(H, marginalized, marginalized));
  const Eigen::MatrixXd H_schur = select(H, remaining, remaining) - gain * H_rm.transpose();
  const Eigen::VectorXd b_schur = b(remaining) - gain * b(marginalized);

  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(H_schur);
  const double floor = kRankTolerance * solver.eigenvalues().cwiseAbs().maxCoeff();
  const Eigen::VectorXd root =
      (solver.eigenvalues().array() > floor).select(solver.eigenvalues().array().sqrt(), 0.0);
  const Eigen::VectorXd inverse_root = (root.array() > 0.0).select(root.array().inverse(), 0.0);
  return {root.asDiagonal() * solver.eigenvectors().transpose(),
          inverse_root.asDiagonal() * (solver.eigenvectors().transpose() * b_schur)};
}

}  // namespace stillpoint
