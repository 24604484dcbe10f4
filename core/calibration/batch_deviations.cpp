// SPDX-License-Identifier: BSD-3-Clause
// Standard deviations of the calibration, see calibrate.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>

#include <ceres/crs_matrix.h>

#include "core/calibration/batch_problem.h"

namespace stillpoint {
namespace {

constexpr double kLeastInformation = 1e-6;  // of each number: of points that almost nothing determines

/// Weighted residuals and their Jacobian; the rows up to the last end are those of clusters.
struct Linearization {
  ceres::CRSMatrix J;
  std::vector<double> r;
  std::vector<int> cluster_ends;  ///< number of rows up to the last one of each cluster
};

/// The variances of the numbers at some columns, see calibrate.h; nullopt if the information is singular.
std::optional<Eigen::VectorXd> variances(const Linearization& at, const std::vector<int>& columns) {
  using RowMajor = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;
  const ceres::CRSMatrix& J = at.J;
  const Eigen::Map<const RowMajor> jacobian(J.num_rows, J.num_cols, static_cast<int>(J.values.size()),
                                            J.rows.data(), J.cols.data(), J.values.data());
  Eigen::SparseMatrix<double> information = RowMajor(jacobian.transpose()) * RowMajor(jacobian);
  for (int i = 0; i < information.cols(); ++i) information.coeffRef(i, i) += kLeastInformation;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(information);
  if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0.0)) return std::nullopt;
  const Eigen::Map<const Eigen::VectorXd> r(at.r.data(), static_cast<Eigen::Index>(at.r.size()));
  Eigen::VectorXd result(static_cast<int>(columns.size()));
  for (int i = 0; i < result.size(); ++i) {
    const int column = columns[static_cast<std::size_t>(i)];
    const Eigen::VectorXd solution = solver.solve(Eigen::VectorXd::Unit(information.cols(), column));
    const Eigen::VectorXd gain = jacobian * solution;
    result[i] = 0.0;
    int begin = 0;
    for (const int end : at.cluster_ends) {
      const double change = gain.segment(begin, end - begin).dot(r.segment(begin, end - begin));
      result[i] += change * change;
      begin = end;
    }
    result[i] += gain.tail(gain.size() - begin).squaredNorm();
  }
  if (!result.allFinite() || !(result.array() > 0.0).all()) return std::nullopt;
  return result;
}

}  // namespace

std::optional<SharedVector> BatchProblem::deviations() {
  SharedValues& shared = state_.shared;
  const std::array<std::pair<double*, SharedValue>, 11> shared_blocks = {
      {{shared.camera.data(), SharedValue::kFx},
       {&shared.readout_s, SharedValue::kReadout},
       {shared.depth.data(), SharedValue::kDepthScale},
       {shared.depth_camera.data(), SharedValue::kDepthFx},
       {shared.T_c_d.data(), SharedValue::kDepthPose},
       {shared.T_b_c.data(), SharedValue::kExtrinsics},
       {&shared.time_offset_s, SharedValue::kTimeOffset},
       {shared.imu_axes.data(), SharedValue::kImuAxes},
       {&shared.depth_delay_s, SharedValue::kDepthDelay},
       {shared.T_f_b.data(), SharedValue::kTruthPose},
       {&shared.truth_delay_s, SharedValue::kTruthDelay}}};
  ceres::Problem::EvaluateOptions options;
  options.residual_blocks = cluster_blocks_;
  std::vector<ceres::ResidualBlockId> all;
  problem_.GetResidualBlocks(&all);
  const std::set<ceres::ResidualBlockId> of_clusters(cluster_blocks_.begin(), cluster_blocks_.end());
  std::ranges::copy_if(all, std::back_inserter(options.residual_blocks),
                       [&](ceres::ResidualBlockId id) { return !of_clusters.contains(id); });
  problem_.GetParameterBlocks(&options.parameter_blocks);
  std::erase_if(options.parameter_blocks,
                [this](const double* block) { return problem_.IsParameterBlockConstant(block); });
  std::vector<int> columns;
  std::vector<int> values;  // shared value of each column
  int column = 0;
  for (const double* block : options.parameter_blocks) {
    const auto found = std::ranges::find(shared_blocks, block, [](const auto& entry) { return entry.first; });
    const int size = problem_.ParameterBlockTangentSize(block);
    for (int i = 0, value = 0; found != shared_blocks.end() && i < size; ++value) {
      // Constant numbers of a block have no column; of a pose, all are variable.
      if (!is_variable(static_cast<SharedValue>(static_cast<int>(found->second) + value))) continue;
      columns.push_back(column + i++);
      values.push_back(static_cast<int>(found->second) + value);
    }
    column += size;
  }
  SharedVector result = SharedVector::Zero();
  if (columns.empty()) return result;
  Linearization at{.J = {}, .r = {}, .cluster_ends = cluster_ends_};
  if (!problem_.Evaluate(options, nullptr, &at.r, nullptr, &at.J)) return std::nullopt;
  const std::optional<Eigen::VectorXd> diagonal = variances(at, columns);
  if (!diagonal) return std::nullopt;
  for (std::size_t i = 0; i < values.size(); ++i)
    result[values[i]] = std::sqrt((*diagonal)[static_cast<Eigen::Index>(i)]);
  return result;
}

}  // namespace stillpoint
