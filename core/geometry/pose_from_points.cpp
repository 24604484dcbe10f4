// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/pose_from_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr double kMinDepth = 0.05;  // [m]
constexpr int kRefineSteps = 8;
constexpr int kStepsFromPrediction = 4;
constexpr std::size_t kMaxScaleErrors = 256;  // of a median
constexpr double kScaleMedians = 1.5;         // 1.8 standard deviations of a coordinate
constexpr double kMinScale = 0.05;            // of the inlier threshold
constexpr PoseRefinement kSampleRefinement{.scale = 1.0, .steps = 5};

template <class Observations>
Pose step(const Pose& T_c_w, const Observations& observations, double scale) {
  Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Identity() * 1e-9;
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  for (const PointObservation& observation : observations) {
    const Eigen::Vector3d p_c = T_c_w * observation.p_w;
    if (p_c.z() < kMinDepth) continue;
    const double inverse_z = 1.0 / p_c.z();
    const Eigen::Vector2d projected = p_c.head<2>() * inverse_z;
    const Eigen::Vector2d error = projected - observation.bearing;
    const Eigen::Matrix<double, 2, 3> J_point = bearing_jacobian(projected, inverse_z);
    Eigen::Matrix<double, 2, 6> J;
    J << J_point, -J_point * skew(p_c);
    const double weight = 1.0 / (1.0 + error.squaredNorm() / (scale * scale));
    H.noalias() += weight * J.transpose() * J;
    b.noalias() += weight * J.transpose() * error;
  }
  const Eigen::Matrix<double, 6, 1> change = -solve_symmetric(H, b);
  return Pose{exp_so3(change.tail<3>()), change.head<3>()} * T_c_w;
}

template <class Observations>
Pose refine(Pose T_c_w, const Observations& observations, const PoseRefinement& refinement) {
  for (int i = 0; i < refinement.steps; ++i) T_c_w = step(T_c_w, observations, refinement.scale);
  return T_c_w;
}

/// Scale of the loss by the errors that most observations have, see `refine_camera_pose`.
double loss_scale(const Pose& T_c_w, std::span<const PointObservation> observations,
                  double inlier_threshold) {
  std::array<double, kMaxScaleErrors> errors;
  std::size_t count = 0;
  const std::size_t stride = 1 + observations.size() / kMaxScaleErrors;
  for (std::size_t i = 0; i < observations.size(); i += stride) {
    const Eigen::Vector3d p_c = T_c_w * observations[i].p_w;
    if (p_c.z() < kMinDepth) continue;
    errors[count++] = (p_c.hnormalized() - observations[i].bearing).norm();
  }
  if (count == 0) return inlier_threshold;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(errors.begin(), middle, errors.begin() + static_cast<std::ptrdiff_t>(count));
  return std::clamp(kScaleMedians * *middle, kMinScale * inlier_threshold, inlier_threshold);
}

}  // namespace

Pose refine_pose(const Pose& T_c_w, std::span<const PointObservation> observations,
                 const PoseRefinement& refinement) {
  return refine(T_c_w, observations, refinement);
}

std::size_t count_inliers(const Pose& T_c_w, std::span<const PointObservation> observations,
                          double threshold) {
  const Eigen::Matrix3d R_c_w = T_c_w.R();
  std::size_t inliers = 0;
  for (const PointObservation& observation : observations) {
    const Eigen::Vector3d p_c = R_c_w * observation.p_w + T_c_w.p;
    // Without a division: |pi(p) - b| < threshold.
    const bool fits =
        p_c.z() >= kMinDepth && (p_c.head<2>() - p_c.z() * observation.bearing).norm() < threshold * p_c.z();
    inliers += fits ? 1 : 0;
  }
  return inliers;
}

double required_samples(double inlier_ratio, const ConsensusOptions& options) {
  if (inlier_ratio >= 1.0) return 0.0;
  return std::log(1.0 - options.confidence) /
         std::log1p(-std::pow(inlier_ratio, static_cast<double>(options.sample_size)));
}

Pose turn_to_bearings(const Pose& T_c_w, std::span<const PointObservation> observations) {
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  for (const PointObservation& seen : observations) {
    M += seen.bearing.homogeneous().normalized() * (T_c_w * seen.p_w).normalized().transpose();
  }
  return Pose{Eigen::Quaterniond(closest_rotation(M).R), Eigen::Vector3d::Zero()} * T_c_w;
}

PoseConsensus sample_poses(std::span<const PointObservation> observations, const Pose& initial,
                           const PoseSampling& sampling, const std::function<std::size_t()>& random) {
  const auto hypothesis = [&]() -> std::optional<Pose> {
    std::array<PointObservation, 4> sample;
    for (PointObservation& drawn : sample) drawn = observations[random() % observations.size()];
    return refine(initial, sample, sampling.refinement);
  };
  const auto inliers = [&](const Pose& pose) {
    return count_inliers(pose, observations, sampling.inlier_threshold);
  };
  return find_consensus(observations.size(), sampling.consensus, hypothesis, inliers);
}

std::optional<CameraPose> estimate_camera_pose(std::span<const PointObservation> observations,
                                               const Pose& prediction, const CameraPoseOptions& options) {
  if (static_cast<int>(observations.size()) < options.min_inliers) return std::nullopt;

  std::mt19937 random(options.seed);
  const double threshold = options.inlier_threshold;
  const PoseRefinement refinement{.scale = threshold, .steps = kRefineSteps};
  const Pose initial = prediction.inverse();
  const Pose refined = refine(initial, observations, refinement);
  const PoseConsensus consensus = sample_poses(observations, initial,
                                               {.consensus = {.max_samples = options.iterations},
                                                .inlier_threshold = threshold,
                                                .refinement = kSampleRefinement},
                                               std::ref(random));
  const bool sampled = consensus.inliers > count_inliers(refined, observations, threshold);
  const Pose best = refine(sampled ? consensus.pose : refined, observations, refinement);
  const auto inliers = static_cast<int>(count_inliers(best, observations, threshold));
  if (inliers < options.min_inliers || !best.p.allFinite()) return std::nullopt;
  return CameraPose{best.inverse(), inliers};
}

Pose refine_camera_pose(std::span<const PointObservation> observations, const Pose& prediction,
                        double inlier_threshold) {
  Pose T_c_w = prediction.inverse();
  for (int i = 0; i < kStepsFromPrediction; ++i) {
    T_c_w = step(T_c_w, observations, loss_scale(T_c_w, observations, inlier_threshold));
  }
  return T_c_w.inverse();
}

}  // namespace stillpoint
