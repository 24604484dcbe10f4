// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/moving_consistency.h"

#include <optional>
#include <utility>

namespace stillpoint {
namespace {

/// Points with a smaller depth are treated as behind the camera [m].
constexpr double kMinDepth_m = 1e-3;

/// P_k^{c_j} of Eq. (6) for observation j; nullopt if its depth is unknown.
std::optional<Eigen::Vector3d> position_in(const ConsistencyView& view, const ConsistencyFeature& feature,
                                           const ConsistencyObservation& observation) {
  if (observation.depth > 0.0) return observation.depth * observation.bearing.homogeneous();
  if (feature.inverse_depth <= 0.0) return std::nullopt;
  const ConsistencyObservation& first = view.observations_of(feature).front();
  const Pose& T_w_cj = view.T_w_c[static_cast<std::size_t>(observation.frame)];
  const Pose& T_w_ci = view.T_w_c[static_cast<std::size_t>(first.frame)];
  const Eigen::Vector3d p_ci = first.bearing.homogeneous() / feature.inverse_depth;
  const double depth = (T_w_cj.inverse() * (T_w_ci * p_ci)).z();
  if (depth <= kMinDepth_m) return std::nullopt;
  return depth * observation.bearing.homogeneous();
}

/// Eq. (6) with frame i = that of `reference`.
ConsistencyResidual residual(const ConsistencyView& view, const ConsistencyFeature& feature,
                             const ConsistencyObservation& reference) {
  ConsistencyResidual result{.id = feature.id};
  const Pose T_ci_w = view.T_w_c[static_cast<std::size_t>(reference.frame)].inverse();
  double sum = 0.0;
  for (const ConsistencyObservation& other : view.observations_of(feature)) {
    if (other.frame == reference.frame) continue;
    const std::optional<Eigen::Vector3d> p_cj = position_in(view, feature, other);
    if (!p_cj) continue;
    const Eigen::Vector3d p_ci = T_ci_w * (view.T_w_c[static_cast<std::size_t>(other.frame)] * *p_cj);
    const bool in_front = p_ci.z() > kMinDepth_m;
    sum += in_front ? (reference.bearing - p_ci.hnormalized()).norm() : 1.0;
    ++result.pair_count;
  }
  if (result.pair_count > 0) result.mean_px = view.focal_px * sum / result.pair_count;
  return result;
}

}  // namespace

std::vector<ConsistencyResidual> consistency_residuals(const ConsistencyView& view,
                                                       std::vector<ConsistencyResidual> recycled) {
  std::vector<ConsistencyResidual> residuals = std::move(recycled);
  residuals.clear();
  for (const ConsistencyFeature& feature : view.features) {
    if (feature.count < 2) continue;
    const ConsistencyResidual result = residual(view, feature, view.observations_of(feature).front());
    if (result.pair_count > 0) residuals.push_back(result);
  }
  return residuals;
}

std::vector<ConsistencyResidual> gate_on_prediction(const ConsistencyView& view,
                                                    std::vector<ConsistencyResidual> recycled) {
  const int newest = static_cast<int>(view.T_w_c.size()) - 1;
  std::vector<ConsistencyResidual> residuals = std::move(recycled);
  residuals.clear();
  for (const ConsistencyFeature& feature : view.features) {
    const ConsistencyObservation& last = view.observations_of(feature).back();
    if (feature.count < 2 || last.frame != newest) continue;
    const ConsistencyResidual result = residual(view, feature, last);
    if (result.pair_count > 0) residuals.push_back(result);
  }
  return residuals;
}

}  // namespace stillpoint
