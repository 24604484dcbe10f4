// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/schur_solver.h"

#include <algorithm>
#include <cmath>

#include "core/backend/factors/gravity_direction.h"
#include "core/backend/solvers/zero_velocity_term.h"
#include "core/geometry/so3.h"

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

void add_to_pose(const ReusableVector& step, int column, double* x) {
  Eigen::Map<Eigen::Vector3d>{x} += step.segment<3>(column);
  Eigen::Map<Eigen::Quaterniond> q(x + 3);
  q = (q * exp_so3(step.segment<3>(column + 3))).normalized();
}

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
  for (int frame = 0; frame <= window.newest(); ++frame) {
    if (has_zero_velocity_term(window, frame))
      cost += add_zero_velocity_term(frame, config, blocks_, system_);
  }
  cost += visual_.add_to(system_, at);
  scale_squared_.states = system_.H.diagonal().cwiseMax(kMinCurvature);
  scale_squared_.landmarks = visual_.information().cwiseMax(kMinCurvature);
  return cost;
}

double SchurSolver::cost_at(const Window& window, const BackendConfig& config,
                            const ParameterBlocks& blocks) {
  double cost = prior_.cost(blocks) + calibration_.cost(blocks) + zero_velocity_cost(window, config, blocks);
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
  for (int frame = 0; frame < layout_.frames(); ++frame) {
    const auto index = static_cast<std::size_t>(frame);
    add_to_pose(step_.states, layout_.column({BlockKind::kPose, frame}), candidate_.pose(index));
    const int column = layout_.column({BlockKind::kSpeedBias, frame});
    if (column >= 0) {
      Eigen::Map<Eigen::Matrix<double, 9, 1>>{candidate_.speed_bias(index)} +=
          step_.states.segment<9>(column);
    }
  }
  const int extrinsics = layout_.column({BlockKind::kExtrinsics});
  if (extrinsics >= 0) add_to_pose(step_.states, extrinsics, candidate_.extrinsics());
  const int time_offset = layout_.column({BlockKind::kTimeOffset});
  if (time_offset >= 0) *candidate_.time_offset() += step_.states[time_offset];
  const int depth_scale = layout_.column({BlockKind::kDepthScale});
  if (depth_scale >= 0) *candidate_.depth_scale() += step_.states[depth_scale];
  const int gravity = layout_.column({BlockKind::kGravity});
  if (gravity >= 0) {
    Eigen::Map<Eigen::Vector3d> g(candidate_.gravity());
    g = rotate_gravity(g, step_.states.segment<2>(gravity));
  }
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
    const double decrease = cost - cost_at(window, config, candidate_);
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

}  // namespace stillpoint
