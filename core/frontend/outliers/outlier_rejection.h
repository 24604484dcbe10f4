// SPDX-License-Identifier: BSD-3-Clause
/// Rejects feature matches that are inconsistent with the camera motion between two frames, by an epipolar
/// geometry or, from points of known depth, by a rigid motion.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/config/frontend_config.h"
#include "core/geometry/pose_from_points.h"

namespace stillpoint {

struct RigidMotionSettings {
  double threshold = 0.002;  ///< largest reprojection error of an inlier [normalized plane]
  double confidence = 0.99;  ///< probability that at least one sample is free of outliers
  bool is_large = false;     ///< the motion turns the camera by more than 30 degrees
};

/// T_to_from, the transform from the earlier to the later camera frame, from points in the earlier one and
/// their bearings in the later: RANSAC over samples of four, then robust refinement over all of them, see
/// pose_from_points.h. The scale of the Cauchy loss is half the inlier threshold, because a pose from four
/// noisy points rejects good matches; samples are fitted by least squares from the identity, as the motion
/// between two frames is small, or else from the rotation between their directions. Deterministic;
/// allocation-free.
/// @return nullopt for fewer than four observations, or if RANSAC finds no pose
[[nodiscard]] std::optional<Pose> estimate_rigid_motion(std::span<const PointObservation> observations,
                                                        const RigidMotionSettings& settings);

/// T_to_from as `estimate_rigid_motion`, of the majority of the points: the sample with the least median of
/// reprojection errors (Rousseeuw 1984) instead of the one with most errors below a threshold, refined with
/// that median as scale of the loss. A camera that follows a near cart and turns against it is within 2 px of
/// cart and scene; for most of the points, a camera that follows the scene is nearer. Samples are not refined
/// before they are compared: that draws them to a motion in between, and the cart is followed more often.
/// Deterministic; allocation-free after the first call. Otherwise stateless.
class MajorityMotion {
 public:
  /// @param observations points in the earlier frame, bearings in the later one
  /// @param settings     the threshold is the largest median of the errors
  /// @return nullopt for fewer than four observations, or a larger median
  [[nodiscard]] std::optional<Pose> estimate(std::span<const PointObservation> observations,
                                             const RigidMotionSettings& settings);

 private:
  [[nodiscard]] double median_error(std::span<const PointObservation> observations, const Pose& T_to_from);

  std::vector<double> squared_errors_;
};

/// One feature observed in two frames.
struct Match {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();  ///< undistorted normalized coordinates, earlier frame
  double depth = 0.0;                              ///< in the earlier frame [m]; 0 = not measured
  Eigen::Vector2d to = Eigen::Vector2d::Zero();    ///< undistorted normalized coordinates, later frame
};

/// 1 = inlier, 0 = outlier, for each match.
using InlierMask = std::vector<std::uint8_t>;

struct OutlierRejectionSettings {
  OutlierModel model = OutlierModel::kEpipolar;
  double threshold_px = 1.0;  ///< largest residual of an inlier, px at the camera's focal length
  double confidence = 0.99;   ///< probability that at least one sample is free of outliers; as in VINS-Mono
  double min_inlier_ratio = 0.5;  ///< models with fewer inliers are discarded
  double focal_px = 0.0;          ///< > 0
  bool is_large = false;          ///< see RigidMotionSettings
};

/// Inliers of the dominant motion, by RANSAC (Fischler and Bolles 1981). Deterministic.
///
/// kEpipolar: fundamental matrix F; residual = distance of `to` to the epipolar line l = F (from, 1)
/// (Hartley and Zisserman 2004, Sec. 11.6). For pure rotation or a planar scene F is not unique, but every
/// solution fits the static matches, so none of them is rejected. Motion along the line is not detected.
///
/// kRigid: camera pose T_to_from estimated from the depths of the earlier frame (`estimate_rigid_motion`);
/// residual = |pi(T_to_from (depth (from, 1))) - to|, pi(p) = (p.x, p.y) / p.z, which covers both directions
/// and has no degenerate motion. Matches without depth use the epipolar line of the pose,
/// l = t x (R (from, 1)), residual = |l . (to, 1)| / |(l.x, l.y)|. The motion between two frames is small
/// compared to the depth, so depth errors have little effect. Falls back to kEpipolar if fewer than 20
/// matches have depth or the pose has too few inliers.
///
/// kMajority: as kRigid, by `MajorityMotion`. Behind a person who covers most of the image it rejects the
/// scene more often, which inertial data would recognize: with an IMU, kRigid is better.
///
/// Not specified by the paper; the published code uses kEpipolar.
///
/// An instance is reused for its buffers; only `motion` and `has_model` are of the last call.
class OutlierRejector {
 public:
  /// @return all ones if there are fewer than 8 matches or no model has enough inliers; valid until the next
  /// call
  [[nodiscard]] const InlierMask& find(std::span<const Match> matches,
                                       const OutlierRejectionSettings& settings);

  /// T_to_from of the last call, if it found a rigid motion.
  [[nodiscard]] const std::optional<Pose>& motion() const { return motion_; }

  /// Whether the last call found a motion with enough inliers, of either model.
  [[nodiscard]] bool has_model() const { return has_model_; }

 private:
  [[nodiscard]] bool fit_epipolar(std::span<const Match> matches, const OutlierRejectionSettings& settings);
  [[nodiscard]] bool fit_rigid(std::span<const Match> matches, const OutlierRejectionSettings& settings);
  [[nodiscard]] bool has_enough_inliers(const OutlierRejectionSettings& settings) const;

  std::vector<PointObservation> correspondences_;
  MajorityMotion majority_motion_;
  InlierMask inliers_;
  std::optional<Pose> motion_;
  bool has_model_ = false;
};

}  // namespace stillpoint
