// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/reduced_system.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "core/backend/factors/imu_residual.h"

namespace stillpoint {
namespace {

constexpr int kMaxBlock = 9;  // columns of the largest block: velocity and biases

/// The blocks whose Jacobians ImuLinearization::jacobian stacks.
std::array<BlockRef, 4> imu_blocks(int frame) {
  return {{{BlockKind::kPose, frame - 1},
           {BlockKind::kSpeedBias, frame - 1},
           {BlockKind::kPose, frame},
           {BlockKind::kSpeedBias, frame}}};
}

std::array<const double*, 6> imu_parameters(int frame, const ParameterBlocks& blocks) {
  const std::array<BlockRef, 4> refs = imu_blocks(frame);
  return {blocks.at(refs[0]),
          blocks.at(refs[1]),
          blocks.at(refs[2]),
          blocks.at(refs[3]),
          blocks.at({BlockKind::kGravity}),
          blocks.at({BlockKind::kTimeOffset})};
}

/// The residual and its Jacobians as written by the factor; `jacobian` stacks the tangent columns of states.
struct ImuLinearization {
  int frame;  ///< the factor is between it and the previous one
  Vector15 residual;
  Eigen::Matrix<double, 15, 7, Eigen::RowMajor> J_pose_i, J_pose_j;
  Eigen::Matrix<double, 15, 9, Eigen::RowMajor> J_speed_bias_i, J_speed_bias_j;
  Eigen::Matrix<double, 15, 3, Eigen::RowMajor> J_gravity;
  Vector15 J_time_offset;

  [[nodiscard]] Eigen::Matrix<double, 15, 30> jacobian() const {
    Eigen::Matrix<double, 15, 30> J;
    J << J_pose_i.leftCols<6>(), J_speed_bias_i, J_pose_j.leftCols<6>(), J_speed_bias_j;
    return J;
  }
};

ImuLinearization linearize_imu(const Window& window, int frame, const Linearization& at) {
  const std::optional<TimedImuResidual::Ends> ends = window.imu_ends(frame);
  const TimedImuResidual residual(*window.frames[static_cast<std::size_t>(frame)].from_previous,
                                  ends ? &*ends : nullptr);
  ImuLinearization out;
  out.frame = frame;
  std::array<double*, 6> jacobians = {out.J_pose_i.data(),  out.J_speed_bias_i.data(),
                                      out.J_pose_j.data(),  out.J_speed_bias_j.data(),
                                      out.J_gravity.data(), out.J_time_offset.data()};
  const bool at_states = !at.at_first_estimates();
  residual.evaluate(imu_parameters(frame, at.states).data(), out.residual.data(),
                    at_states ? jacobians.data() : nullptr);
  if (at_states) return out;
  Vector15 unused;
  residual.evaluate(imu_parameters(frame, at.point).data(), unused.data(), jacobians.data());
  return out;
}

/// Adds the rows of a global state in J^T J and J^T r of the factor, without its blocks with other global
/// states. @param J derivative of the residual by the state
template <int Columns>
void add_global_rows(BlockKind kind, const Eigen::Matrix<double, 15, Columns>& J,
                     const ImuLinearization& linear, ReducedSystem& system) {
  const int row = system.layout.column({kind});
  const std::array<BlockRef, 2> profile = {{{BlockKind::kSpeedBias, linear.frame}, {kind}}};
  system.widen_profile(profile);
  system.g.segment<Columns>(row) += J.transpose() * linear.residual;
  system.add(row, row, J.transpose() * J);
  const Eigen::Matrix<double, Columns, 30> H = J.transpose() * linear.jacobian();
  int column = 0;
  for (const BlockRef block : imu_blocks(linear.frame)) {
    const int size = local_size(block.kind);
    system.add(row, system.layout.column(block), H.middleCols(column, size));
    column += size;
  }
}

using PriorJacobian = ReusableMatrix<Eigen::MatrixXd>;

bool has_same_bits(const PriorJacobian& a, const PriorJacobian& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
  return a.size() == 0 ||
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

}  // namespace

void ReducedSystem::reset(const ReducedLayout& new_layout) {
  layout = new_layout;
  const int size = layout.size();
  H.resize(size, size);
  // The lower triangle, and all of the blocks on the diagonal.
  for (int row = 0; row < size; ++row) H.row(row).head(std::min(row + kMaxBlock, size)).setZero();
  g.resize(size);
  g.setZero();
  first.resize(static_cast<std::size_t>(size / kTile));
  for (std::size_t i = 0; i < first.size(); ++i) {
    const int row = kTile * static_cast<int>(i);
    first[i] = std::min(row, row < layout.first_pose() ? row / 9 * 9 : layout.first_pose());
  }
}

void ReducedSystem::widen_profile(std::span<const BlockRef> blocks) {
  int begin = layout.size();
  for (const BlockRef block : blocks) {
    const int column = layout.column(block);
    if (column >= 0) begin = std::min(begin, column);
  }
  for (const BlockRef block : blocks) {
    const int column = layout.column(block);
    for (int row = column; column >= 0 && row < column + local_size(block.kind); row += kTile) {
      int& start = first[static_cast<std::size_t>(row / kTile)];
      start = std::min(start, begin);
    }
  }
}

void ReducedSystem::copy_profile_to(ReusableMatrix<RowMajorMatrix>& S) const {
  S.resize(H.rows(), H.cols());
  for (Eigen::Index row = 0; row < H.rows(); ++row) {
    const int begin = first[static_cast<std::size_t>(row / kTile)];
    S.row(row).segment(begin, row + 1 - begin) = H.row(row).segment(begin, row + 1 - begin);
  }
}

bool has_imu_term(const Window& window, int frame) {
  return window.inertial && window.frames[static_cast<std::size_t>(frame)].from_previous.has_value();
}

double imu_cost(const Window& window, int frame, const ParameterBlocks& blocks) {
  Vector15 residual;
  const std::optional<TimedImuResidual::Ends> ends = window.imu_ends(frame);
  TimedImuResidual(*window.frames[static_cast<std::size_t>(frame)].from_previous, ends ? &*ends : nullptr)
      .evaluate(imu_parameters(frame, blocks).data(), residual.data(), nullptr);
  return 0.5 * residual.squaredNorm();
}

double add_imu_term(const Window& window, int frame, const Linearization& at, ReducedSystem& system) {
  system.widen_profile(imu_blocks(frame));
  const ImuLinearization linear = linearize_imu(window, frame, at);
  const Eigen::Matrix<double, 15, 30> J = linear.jacobian();
  const Eigen::Matrix<double, 30, 30> H = J.transpose() * J;
  const Eigen::Matrix<double, 30, 1> g = J.transpose() * linear.residual;
  const std::array<BlockRef, 4> refs = imu_blocks(frame);
  int row = 0;
  for (const BlockRef a : refs) {
    const int size_a = local_size(a.kind);
    const int column_a = system.layout.column(a);
    system.g.segment(column_a, size_a) += g.segment(row, size_a);
    int column = 0;
    for (const BlockRef b : refs) {
      system.add(column_a, system.layout.column(b), H.block(row, column, size_a, local_size(b.kind)));
      column += local_size(b.kind);
    }
    row += size_a;
  }
  const Eigen::Matrix<double, 15, 2> J_gravity = linear.J_gravity.leftCols<2>();
  const VariableGlobals& variable = system.layout.variable_globals();
  if (variable.gravity) add_global_rows(BlockKind::kGravity, J_gravity, linear, system);
  if (variable.time_offset && window.time_offset_model == TimeOffsetModel::kInertial) {
    add_global_rows(BlockKind::kTimeOffset, linear.J_time_offset, linear, system);
    system.add(system.layout.column({BlockKind::kTimeOffset}), system.layout.column({BlockKind::kGravity}),
               linear.J_time_offset.transpose() * J_gravity);
  }
  return 0.5 * linear.residual.squaredNorm();
}

void PriorTerm::read(const LinearPrior& prior) {
  prior_ = &prior;
  blocks_.clear();
  for (const PriorBlock& block : prior.blocks) blocks_.push_back({block.kind, block.frame});
  const Eigen::Index size = prior.jacobian.cols();
  if (!has_same_bits(prior.jacobian, jacobian_)) {
    jacobian_ = prior.jacobian;
    information_.resize(size, size);
    information_.setZero();
    information_.selfadjointView<Eigen::Lower>().rankUpdate(prior.jacobian.transpose());
  }
  difference_.resize(size);
  gradient_.resize(size);
}

double PriorTerm::cost(const ParameterBlocks& blocks) {
  int column = 0;
  for (const PriorBlock& block : prior_->blocks) {
    const int size = local_size(block.kind);
    difference_.segment(column, size) =
        block_difference(block.kind, blocks.at({block.kind, block.frame}), block.linearization);
    column += size;
  }
  error_ = prior_->residual;
  error_.noalias() += prior_->jacobian * difference_;
  return 0.5 * error_.squaredNorm();
}

double PriorTerm::add_to(ReducedSystem& system, const ParameterBlocks& blocks) {
  const double cost_now = cost(blocks);
  gradient_.noalias() = prior_->jacobian.transpose() * error_;
  int row = 0;
  for (std::size_t a = 0; a < blocks_.size(); ++a) {
    const int size_a = local_size(blocks_[a].kind);
    const int to_row = system.layout.column(blocks_[a]);
    if (to_row >= 0) system.g.segment(to_row, size_a) += gradient_.segment(row, size_a);
    int column = 0;
    for (std::size_t b = 0; b <= a; ++b) {
      const int size_b = local_size(blocks_[b].kind);
      const int to_column = system.layout.column(blocks_[b]);
      const auto block = information_.block(row, column, size_a, size_b);
      system.add(to_row, to_column, block);
      if (a != b) system.add(to_column, to_row, block.transpose());
      column += size_b;
    }
    row += size_a;
  }
  return cost_now;
}

}  // namespace stillpoint
