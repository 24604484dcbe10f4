// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/moving_consistency.h"

#include <limits>
#include <optional>
#include <utility>

#include <Eigen/LU>

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

/// Means over the pairs (i, j), in camera frame i.
struct MeanPair {
  ConsistencyResidual residual;
  Eigen::Vector2d difference = Eigen::Vector2d::Zero();  ///< of the observation and the projections
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    ///< of the feature [m]
  bool in_front = true;                                  ///< in all pairs
};

/// Eq. (6) with frame i = that of `reference`.
MeanPair mean_pair(const ConsistencyView& view, const ConsistencyFeature& feature,
                   const ConsistencyObservation& reference) {
  MeanPair mean{.residual = {.id = feature.id}};
  const Pose T_ci_w = view.T_w_c[static_cast<std::size_t>(reference.frame)].inverse();
  double sum = 0.0;
  for (const ConsistencyObservation& other : view.observations_of(feature)) {
    if (other.frame == reference.frame) continue;
    const std::optional<Eigen::Vector3d> p_cj = position_in(view, feature, other);
    if (!p_cj) continue;
    const Eigen::Vector3d p_ci = T_ci_w * (view.T_w_c[static_cast<std::size_t>(other.frame)] * *p_cj);
    ++mean.residual.pair_count;
    if (p_ci.z() <= kMinDepth_m) {
      mean.in_front = false;
      sum += 1.0;
      continue;
    }
    const Eigen::Vector2d difference = reference.bearing - p_ci.hnormalized();
    sum += difference.norm();
    mean.difference += difference;
    mean.position += p_ci;
  }
  const int pairs = mean.residual.pair_count;
  if (pairs == 0) return mean;
  mean.residual.mean_px = view.focal_px * sum / pairs;
  mean.difference /= pairs;
  mean.position /= pairs;
  return mean;
}

double squared_distance(const MeanPair& mean, const PredictionError& error) {
  if (!mean.in_front) return std::numeric_limits<double>::infinity();
  const double variance = error.bearing_sigma * error.bearing_sigma * (1.0 + 1.0 / mean.residual.pair_count);
  const Eigen::Matrix2d S =
      projection_covariance(error.camera, mean.position) + variance * Eigen::Matrix2d::Identity();
  return mean.difference.dot(S.inverse() * mean.difference);
}

}  // namespace

std::vector<ConsistencyResidual> consistency_residuals(const ConsistencyView& view,
                                                       std::vector<ConsistencyResidual> recycled) {
  std::vector<ConsistencyResidual> residuals = std::move(recycled);
  residuals.clear();
  for (const ConsistencyFeature& feature : view.features) {
    if (feature.count < 2) continue;
    const ConsistencyResidual result =
        mean_pair(view, feature, view.observations_of(feature).front()).residual;
    if (result.pair_count > 0) residuals.push_back(result);
  }
  return residuals;
}

std::vector<ConsistencyResidual> gate_on_prediction(const ConsistencyView& view,
                                                    const std::optional<PredictionError>& error,
                                                    std::vector<ConsistencyResidual> recycled) {
  const int newest = static_cast<int>(view.T_w_c.size()) - 1;
  std::vector<ConsistencyResidual> residuals = std::move(recycled);
  residuals.clear();
  for (const ConsistencyFeature& feature : view.features) {
    const ConsistencyObservation& last = view.observations_of(feature).back();
    if (feature.count < 2 || last.frame != newest) continue;
    MeanPair mean = mean_pair(view, feature, last);
    if (mean.residual.pair_count == 0) continue;
    if (error) mean.residual.squared_distance = squared_distance(mean, *error);
    residuals.push_back(mean.residual);
  }
  return residuals;
}

const std::vector<std::int64_t>& StaticReadmission::update(const ConsistencyView& view) {
  std::swap(previous_, anchors_);
  anchors_.clear();
  readmitted_.clear();
  if (view.T_w_c.empty()) return readmitted_;  // the only frame could not be located
  const Pose& T_w_c = view.T_w_c.back();
  const Pose T_c_w = T_w_c.inverse();
  const auto is_static = [&](const Anchor& anchor, const Eigen::Vector2d& bearing) {
    const Eigen::Vector3d p_c = T_c_w * anchor.p_w;
    return p_c.z() > 0.0 && view.focal_px * (p_c.hnormalized() - bearing).norm() <= static_residual_px_;
  };
  auto known = previous_.begin();
  for (const ConsistencyFeature& feature : view.features) {
    const ConsistencyObservation& observation = view.observations_of(feature).back();
    while (known != previous_.end() && known->id < feature.id) ++known;
    const bool is_known = known != previous_.end() && known->id == feature.id;
    if (is_known && is_static(*known, observation.bearing)) {
      anchors_.push_back({.id = feature.id, .p_w = known->p_w, .static_frames = known->static_frames + 1});
      if (known->static_frames + 1 >= min_static_frames_) readmitted_.push_back(feature.id);
    } else if (observation.depth > 0.0) {
      const Eigen::Vector3d p_c = observation.depth * observation.bearing.homogeneous();
      anchors_.push_back({.id = feature.id, .p_w = T_w_c * p_c});
    }
  }
  return readmitted_;
}

}  // namespace stillpoint
