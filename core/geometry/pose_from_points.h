// SPDX-License-Identifier: BSD-3-Clause
/// Camera pose from points of known position and the bearings under which the camera observes them (PnP),
/// some of them wrong: consensus over small samples, then robust refinement. The pose is T_c_w, world to
/// camera; the world may be another camera. Used for the newest frame of the window; the motion between two
/// frames and loops share the consensus, loops also the projection.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "core/geometry/pose.h"

namespace stillpoint {

/// A point and its observed bearing.
struct PointObservation {
  Eigen::Vector3d p_w = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector2d bearing =
      Eigen::Vector2d::Zero();  ///< (x / z, y / z) in the camera: normalized image plane
};

/// Derivative D_pi(p) of the bearing pi(p) = (x / z, y / z) by the point p in the camera frame, z > 0:
///
///   D_pi = (1 / z) [ 1  0  -x/z ;  0  1  -y/z ]
///
/// @param bearing (x / z, y / z)
/// @param inverse_z 1 / z [1/m]
[[nodiscard]] inline Eigen::Matrix<double, 2, 3> bearing_jacobian(const Eigen::Vector2d& bearing,
                                                                  double inverse_z) {
  Eigen::Matrix<double, 2, 3> J;
  J << inverse_z, 0.0, -bearing.x() * inverse_z, 0.0, inverse_z, -bearing.y() * inverse_z;
  return J;
}

/// Derivative of bearing and inverse depth (x / z, y / z, 1 / z): the rows of `bearing_jacobian`, and
/// (0, 0, -1 / z^2).
[[nodiscard]] inline Eigen::Matrix3d inverse_depth_jacobian(const Eigen::Vector2d& bearing,
                                                            double inverse_z) {
  Eigen::Matrix3d J;
  J << bearing_jacobian(bearing, inverse_z), 0.0, 0.0, -inverse_z * inverse_z;
  return J;
}

/// Number of steps of a refinement, and the scale of its loss.
struct PoseRefinement {
  double scale = 1.0;  ///< c [normalized image plane]; 1 and more: practically least squares
  int steps = 5;
};

/// Gauss-Newton from an initial pose. With p'_i = T_c_w p_i and r_i = pi(p'_i) - b_i, it minimizes the Cauchy
/// loss
///
///   sum_i c^2 log(1 + |r_i|^2 / c^2)
///
/// over the left perturbation T_c_w <- (Exp(theta), t) T_c_w, that is p'_i <- Exp(theta) p'_i + t:
///
///   J_i = D_pi(p'_i) [ I  -[p'_i]x ],   w_i = 1 / (1 + |r_i|^2 / c^2)       (Holland and Welsch 1977)
///   (sum_i w_i J_i^T J_i + 1e-9 I) (t, theta) = -sum_i w_i J_i^T r_i
///
/// Points less than 5 cm in front of the camera are left out. Allocation-free.
[[nodiscard]] Pose refine_pose(const Pose& T_c_w, std::span<const PointObservation> observations,
                               const PoseRefinement& refinement);

/// The pose turned about the camera so that the directions of the points agree best with their bearings: an
/// initial pose for `refine_pose` where a rotation of more than 20 degrees is not known. With n(x) = x / |x|,
///
///   R T_c_w,   R = argmax sum_i n(b_i, 1)^T R n(T_c_w p_i)
[[nodiscard]] Pose turn_to_bearings(const Pose& T_c_w, std::span<const PointObservation> observations);

/// Observations with |pi(T_c_w p) - b| < threshold, at least 5 cm in front of the camera.
[[nodiscard]] std::size_t count_inliers(const Pose& T_c_w, std::span<const PointObservation> observations,
                                        double threshold);

/// A pose and the number of observations that agree with it.
struct PoseConsensus {
  Pose pose;
  std::size_t inliers = 0;
};

/// When to stop drawing samples.
struct ConsensusOptions {
  int max_samples = 60;
  std::size_t sample_size = 4;
  /// Probability that at least one sample is free of outliers; 1: all `max_samples` are drawn.
  double confidence = 1.0;
};

/// Number N of samples of n observations of which at least one is free of outliers with probability c, at an
/// inlier ratio w > 0 (Fischler and Bolles 1981):  N = log(1 - c) / log(1 - w^n).
[[nodiscard]] double required_samples(double inlier_ratio, const ConsensusOptions& options);

/// RANSAC (Fischler and Bolles 1981): the first of the hypotheses with the most inliers.
/// @param observations,options number of all observations; limit and confidence
/// @param hypothesis   () -> std::optional<Pose>: pose of the next sample, nullopt if that determines none
/// @param inliers      (pose) -> std::size_t: number of observations that agree with it
/// @return without inliers if no hypothesis has any
template <class Hypothesis, class Inliers>
[[nodiscard]] PoseConsensus find_consensus(std::size_t observations, const ConsensusOptions& options,
                                           const Hypothesis& hypothesis, const Inliers& inliers) {
  PoseConsensus best;
  double required = options.max_samples;
  for (int drawn = 0; drawn < options.max_samples && drawn < required; ++drawn) {
    const std::optional<Pose> pose = hypothesis();
    if (!pose) continue;
    const std::size_t count = inliers(*pose);
    if (count <= best.inliers) continue;
    best = {*pose, count};
    required = required_samples(static_cast<double>(count) / static_cast<double>(observations), options);
  }
  return best;
}

/// How hypotheses are computed from samples of four observations: one more than the minimum averages noise
/// and avoids ambiguous solutions.
struct PoseSampling {
  ConsensusOptions consensus;
  double inlier_threshold = 0.01;  ///< bearing error [normalized image plane]
  PoseRefinement refinement;       ///< of a sample, from the initial pose
};

/// Consensus over samples, each refined from the same initial pose. Allocation-free.
/// @param observations,sampling at least one; how hypotheses are computed
/// @param initial predicted T_c_w, accurate to about 20 degrees
/// @param random source of random numbers, called four times per sample; determines the result
[[nodiscard]] PoseConsensus sample_poses(std::span<const PointObservation> observations, const Pose& initial,
                                         const PoseSampling& sampling,
                                         const std::function<std::size_t()>& random);

struct CameraPoseOptions {
  double inlier_threshold = 0.01;  ///< bearing error [normalized image plane]
  int iterations = 60;             ///< RANSAC hypotheses
  int min_inliers = 8;
  std::uint32_t seed = 1;
};

struct CameraPose {
  Pose T_w_c;
  int inliers = 0;
};

/// Pose T_w_c of a camera: the better of a refinement from the prediction and a consensus, refined with the
/// inlier threshold as the scale of the loss.
/// The prediction of T_w_c is the initial guess of every hypothesis: it should be accurate to about 20
/// degrees
/// @return nothing if no pose has `min_inliers` inliers
[[nodiscard]] std::optional<CameraPose> estimate_camera_pose(std::span<const PointObservation> observations,
                                                             const Pose& prediction,
                                                             const CameraPoseOptions& options);

/// Four steps from a prediction of T_w_c that is close to the solution, without consensus. The scale c of the
/// loss follows from the errors at each step,
///
///   c = min(1.5 median_i |r_i|, threshold),    but at least 0.05 threshold.
///
/// With the threshold itself (3 px), one point on a person 0.45 m before the camera, with an error of 9 px,
/// outweighs 36 points 2 m away with 0.2 px: the loss that it saves, c^2 log(1 + 81 / c^2), is larger than
/// that of a pose which is 8 mm off. Allocation-free; the median is that of at most 256 points.
/// @param observations of points of known position
/// @param prediction T_w_c
/// @param inlier_threshold largest scale of the loss [normalized image plane]
[[nodiscard]] Pose refine_camera_pose(std::span<const PointObservation> observations, const Pose& prediction,
                                      double inlier_threshold);

}  // namespace stillpoint
