// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/schur_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/backend/solvers/marginalization.h"
#include "core/backend/solvers/reduced_system.h"
#include "core/backend/solvers/window_solver.h"

namespace stillpoint {
namespace {

// Trust-region parameters of Ceres (Nocedal and Wright 2006, Sec. 4.1), so that both solvers take equal
// steps.
constexpr double kFirstRadius = 1e4;           // in the norm |dx|_D
constexpr double kMinRelativeDecrease = 1e-3;  // gain ratio above which a step is accepted
constexpr double kPoorModel = 0.25;            // gain ratio below which the radius shrinks
constexpr double kGoodModel = 0.75;            // gain ratio above which the radius grows

/// Lower bound of D, and the range of mu (see SchurSolver).
constexpr double kMinCurvature = 1e-6;
constexpr double kFirstDamping = 1e-8;
constexpr double kLastDamping = 1.0;

}  // namespace

void SchurSolver::read(const Window& window, const BackendConfig& config, double focal_px,
                       VariableGlobals variable) {
  blocks_.assign(window);
  candidate_.assign(window);
  visual_.read(window, config, focal_px, LandmarkSelection::kAll);
  prior_.read(window.prior);
  calibration_.read(window.calibration);
  layout_ = ReducedLayout(static_cast<int>(window.frames.size()), window.inertial, variable);
}

double SchurSolver::linearize(const Window& window, const BackendConfig& config) {
  system_.reset(layout_);
  system_.widen_profile(prior_.blocks());
  const Linearization at = linearize_at(blocks_, window, config, point_);
  double cost = prior_.add_to(system_, blocks_) + calibration_.add_to(system_, blocks_);
  for (int frame = 1; frame <= window.newest(); ++frame) {
    if (has_imu_term(window, frame)) cost += add_imu_term(window, frame, at, system_);
  }
  cost += visual_.add_to(system_, at);
  scale_squared_.states = system_.H.diagonal().cwiseMax(kMinCurvature);
  scale_squared_.landmarks = visual_.information().cwiseMax(kMinCurvature);
  return cost;
}

double SchurSolver::cost_at(const Window& window, const ParameterBlocks& blocks) {
  double cost = prior_.cost(blocks) + calibration_.cost(blocks);
  for (int frame = 1; frame <= window.newest(); ++frame) {
    if (has_imu_term(window, frame)) cost += imu_cost(window, frame, blocks);
  }
  return cost + visual_.cost(blocks);
}

bool SchurSolver::compute_newton_step() {
  for (double damping = kFirstDamping; damping <= kLastDamping; damping *= 10.0) {
    system_.copy_profile_to(S_);
    S_.diagonal() += damping * scale_squared_.states;
    newton_.states = -system_.g;
    visual_.eliminate(damping, S_, newton_.states);
    if (!skyline_factorize(system_.first, S_)) continue;
    skyline_solve(system_.first, S_, newton_.states);
    coupling_product_.resize(visual_.coupling().cols());
    coupling_product_.noalias() =
        visual_.coupling().transpose() * newton_.states.tail(visual_.coupling().rows());
    newton_.landmarks =
        -(visual_.gradient() + coupling_product_).cwiseQuotient((1.0 + damping) * scale_squared_.landmarks);
    return newton_.states.allFinite();
  }
  return false;
}

/// |dx|_D.
double SchurSolver::scaled_norm(const Direction& direction) const {
  return std::sqrt(direction.states.cwiseAbs2().dot(scale_squared_.states) +
                   direction.landmarks.cwiseAbs2().dot(scale_squared_.landmarks));
}

double SchurSolver::curvature(const Direction& direction) {
  coupling_product_.resize(visual_.coupling().cols());
  coupling_product_.noalias() =
      visual_.coupling().transpose() * direction.states.tail(visual_.coupling().rows());
  product_.resize(direction.states.size());
  product_.noalias() = system_.H.selfadjointView<Eigen::Lower>() * direction.states;
  return direction.states.dot(product_) + 2.0 * direction.landmarks.dot(coupling_product_) +
         direction.landmarks.cwiseAbs2().dot(visual_.information());
}

double SchurSolver::predicted_decrease(const Direction& direction) {
  return -direction.states.dot(system_.g) - direction.landmarks.dot(visual_.gradient()) -
         0.5 * curvature(direction);
}

/// Powell's dogleg step (see SchurSolver).
void SchurSolver::compute_dogleg_step(double radius) {
  if (scaled_norm(newton_) <= radius) {
    step_ = newton_;
    return;
  }
  cauchy_.states = -system_.g.cwiseQuotient(scale_squared_.states);
  cauchy_.landmarks = -visual_.gradient().cwiseQuotient(scale_squared_.landmarks);
  const double slope = cauchy_.states.dot(system_.g) + cauchy_.landmarks.dot(visual_.gradient());
  const double length = scaled_norm(cauchy_);
  const double factor = std::min(-slope / curvature(cauchy_), radius / length);
  step_.states = factor * cauchy_.states;
  step_.landmarks = factor * cauchy_.landmarks;
  if (factor * length >= radius) return;

  // |step + fraction * (newton - step)|_D = radius
  cauchy_.states = newton_.states - step_.states;
  cauchy_.landmarks = newton_.landmarks - step_.landmarks;
  const double a = std::pow(scaled_norm(cauchy_), 2);
  const double b =
      (step_.states.array() * cauchy_.states.array() * scale_squared_.states.array()).sum() +
      (step_.landmarks.array() * cauchy_.landmarks.array() * scale_squared_.landmarks.array()).sum();
  const double c = std::pow(factor * length, 2) - radius * radius;  // negative
  const double fraction = -c / (b + std::sqrt(b * b - a * c));
  step_.states += fraction * cauchy_.states;
  step_.landmarks += fraction * cauchy_.landmarks;
}

void SchurSolver::apply_step() {
  candidate_ = blocks_;
  const auto displace = [this](BlockRef block) {
    const int column = layout_.column(block);
    if (column >= 0) displace_block(block.kind, step_.states.data() + column, candidate_.at(block));
  };
  for (int frame = 0; frame < layout_.frames(); ++frame) {
    displace({BlockKind::kPose, frame});
    displace({BlockKind::kSpeedBias, frame});
  }
  for (const BlockKind kind : kGlobalKinds) displace({kind});
  visual_.apply_step(step_.landmarks, candidate_);
}

SolveReport SchurSolver::iterate(const Window& window, const BackendConfig& config) {
  SolveReport report;
  double cost = linearize(window, config);
  report.initial_cost = cost;
  report.iterations = 1;  // the initial evaluation counts, as in Ceres
  report.usable = std::isfinite(cost) && compute_newton_step();
  double radius = kFirstRadius;
  while (report.usable && report.iterations <= config.max_iterations) {
    ++report.iterations;
    compute_dogleg_step(radius);
    const double predicted = predicted_decrease(step_);
    if (!(predicted > 0.0)) break;  // at the minimum, up to rounding errors
    apply_step();
    const double decrease = cost - cost_at(window, candidate_);
    const bool converged = std::abs(decrease) <= config.function_tolerance * cost;
    const double quality = decrease / predicted;
    const double length = scaled_norm(step_);
    if (quality > kGoodModel) radius = std::max(radius, 3.0 * length);
    if (!(quality >= kPoorModel)) radius = 0.5 * length;
    if (quality > kMinRelativeDecrease) {
      std::swap(blocks_, candidate_);
      cost -= decrease;
      if (converged || report.iterations > config.max_iterations) break;
      cost = linearize(window, config);
      if (!compute_newton_step()) break;
    } else if (converged) {
      break;
    }
  }
  report.final_cost = cost;
  return report;
}

SolveReport SchurSolver::minimize(Window& window, const BackendConfig& config, double focal_px) {
  read(window, config, focal_px, solved_globals(window, config));
  SolveReport report = iterate(window, config);
  report.landmarks = visual_.landmarks();
  report.depth_landmarks = visual_.measured_landmarks();
  if (report.usable) unpack(blocks_, window);
  return report;
}

namespace {

/// Smallest ratio of a pivot to its diagonal entry; below it cancellation makes Cholesky inaccurate and the
/// eigendecomposition is used instead.
constexpr double kMinPivotRatio = 1e-11;

}  // namespace

void SchurSolver::append_columns(BlockRef block) {
  for (int i = 0; i < local_size(block.kind); ++i) columns_.push_back(system_.layout.column(block) + i);
}

/// Computes the Cholesky factor L of the system in the order of `columns_`, in place in S_; rows up to the
/// next multiple of kTile are those of the identity.
/// @return false if it would be inaccurate
bool SchurSolver::factorize_columns() {
  const auto size = static_cast<Eigen::Index>(columns_.size());
  const Eigen::Index padded = (size + kTile - 1) / kTile * kTile;
  S_.resize(padded, padded);
  S_.bottomRows(padded - size).setZero();
  S_.diagonal().tail(padded - size).setOnes();
  for (Eigen::Index row = 0; row < size; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      const auto [smaller, larger] =
          std::minmax(columns_[static_cast<std::size_t>(row)], columns_[static_cast<std::size_t>(column)]);
      S_(row, column) = system_.H(larger, smaller);
    }
  }
  diagonal_ = S_.diagonal();
  dense_.assign(static_cast<std::size_t>(padded / kTile), 0);
  return skyline_factorize(dense_, S_) &&
         (kMinPivotRatio * S_.diagonal().cwiseAbs2().cwiseProduct(diagonal_)).maxCoeff() < 1.0;
}

/// With H = L L^T in the order (m, r), L_rr L_rr^T = H_rr - H_rm H_mm^-1 H_mr.
/// @param prior with its blocks; its matrices are replaced
/// @param marginalized number of leading `columns_` to marginalize; `newton_.states` holds -b
LinearPrior SchurSolver::with_square_root(LinearPrior prior, Eigen::Index marginalized) {
  if (!factorize_columns()) {
    const Eigen::MatrixXd H = system_.H.selfadjointView<Eigen::Lower>();
    const std::vector<int> marginalized_columns(columns_.begin(), columns_.begin() + marginalized);
    const std::vector<int> remaining_columns(columns_.begin() + marginalized, columns_.end());
    const SquareRoot root = eliminate(H, -newton_.states, marginalized_columns, remaining_columns);
    prior.jacobian = root.jacobian;
    prior.residual = root.residual;
    return prior;
  }
  step_.states.resize(S_.rows());
  step_.states.tail(S_.rows() - static_cast<Eigen::Index>(columns_.size())).setZero();
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    step_.states[static_cast<Eigen::Index>(i)] = -newton_.states[columns_[i]];
  }
  skyline_forward(dense_, S_, step_.states);
  S_.diagonal() = S_.diagonal().cwiseInverse();
  const Eigen::Index remaining = static_cast<Eigen::Index>(columns_.size()) - marginalized;
  prior.residual = step_.states.segment(marginalized, remaining);
  prior.jacobian.resize(remaining, remaining);
  prior.jacobian.setZero();
  prior.jacobian.triangularView<Eigen::Upper>() =
      S_.block(marginalized, marginalized, remaining, remaining).transpose();
  return prior;
}

LinearPrior SchurSolver::marginalize_oldest(const Window& window, const BackendConfig& config,
                                            double focal_px, LinearPrior recycled) {
  blocks_.assign(window);
  visual_.read(window, config, focal_px, LandmarkSelection::kHostedByOldest);
  system_.reset(ReducedLayout(static_cast<int>(window.frames.size()), window.inertial,
                              marginalized_globals(window, config)));
  prior_.read(window.prior);
  prior_.add_to(system_, blocks_);
  const Linearization at = linearize_at(blocks_, window, config, point_);
  if (window.newest() >= 1 && has_imu_term(window, 1)) add_imu_term(window, 1, at, system_);
  visual_.add_to(system_, at);
  newton_.states = -system_.g;
  visual_.eliminate(0.0, system_.H, newton_.states);

  columns_.clear();
  append_columns({BlockKind::kPose, 0});
  if (window.inertial) append_columns({BlockKind::kSpeedBias, 0});
  const auto marginalized = static_cast<Eigen::Index>(columns_.size());
  LinearPrior prior = std::move(recycled);
  prior.blocks.clear();
  prior_blocks_ = candidate_blocks(window, config, std::move(prior_blocks_));
  for (const BlockRef block : prior_blocks_) {
    const int size = local_size(block.kind);
    if (system_.H.diagonal().segment(system_.layout.column(block), size).isZero(0.0)) continue;
    append_columns(block);
    prior.blocks.push_back(prior_block_after_slide(block, at.point));
  }
  if (prior.blocks.empty()) return prior;
  prior = with_square_root(std::move(prior), marginalized);
  if (at.at_first_estimates()) move_residual_to_linearization(blocks_, prior);
  return prior;
}

std::optional<WindowCovariance> SchurSolver::covariance(const Window& window, const BackendConfig& config,
                                                        double focal_px, bool oldest_motion) {
  read(window, config, focal_px, variable_globals(window, config));
  static_cast<void>(linearize(window, config));
  system_.copy_profile_to(S_);
  newton_.states = -system_.g;
  visual_.eliminate(0.0, S_, newton_.states);
  S_.diagonal().tail(layout_.padding()).setOnes();
  if (!skyline_factorize(system_.first, S_)) return std::nullopt;

  prior_blocks_ = newest_blocks(window, config, std::move(prior_blocks_));
  const NewestMatrix newest = inverse_blocks(prior_blocks_);
  if (!newest.allFinite()) return std::nullopt;
  WindowCovariance result{.newest = state_covariance(prior_blocks_, newest)};
  skyline_solve(system_.first, S_, newton_.states);
  NewestVector step(static_cast<Eigen::Index>(columns_.size()));  // a view by columns_ would copy them
  for (std::size_t i = 0; i < columns_.size(); ++i)
    step[static_cast<Eigen::Index>(i)] = newton_.states[columns_[i]];
  result.rig_step = rig_step(prior_blocks_, step);
  if (oldest_motion) result.oldest_motion = oldest_motion_of(window, inverse_blocks(kOldestPoses));
  return result;
}

/// The rows and columns of the blocks in S^-1.
NewestMatrix SchurSolver::inverse_blocks(std::span<const BlockRef> blocks) {
  columns_.clear();
  for (const BlockRef block : blocks) append_columns(block);
  unit_columns_.resize(layout_.size(), ForwardColumns::ColsAtCompileTime);
  unit_columns_.setZero();
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    unit_columns_(columns_[i], static_cast<Eigen::Index>(i)) = 1.0;
  }
  const int begin = *std::min_element(columns_.begin(), columns_.end()) / kTile * kTile;
  skyline_forward(system_.first, S_, begin, unit_columns_);
  const auto used = unit_columns_.leftCols(static_cast<Eigen::Index>(columns_.size()));
  return used.transpose().lazyProduct(used);
}

}  // namespace stillpoint
