// SPDX-License-Identifier: BSD-3-Clause
/// How well vision determines the newest camera pose, and how well it agrees with a prediction, by the
/// normalized innovation squared (NIS): with an innovation v of n dimensions and its covariance S,
/// v^T S^-1 v / n is 1 in the mean if both covariances are true. Bar-Shalom et al., "Estimation with
/// Applications to Tracking and Navigation", 2001, Sec. 5.4.
#pragma once

#include <optional>
#include <vector>

#include "core/backend/vision/camera_pose.h"
#include "core/backend/window/window.h"
#include "core/geometry/covariance.h"

namespace stillpoint {

/// Information of static points of known position about a camera pose. With the Jacobians J_k of the bearings
/// by the pose and their standard deviation s,
///
///   H = sum over inliers k of J_k^T J_k / s^2,    covariance = H^-1.
struct VisionAssessment {
  int features = 0;        ///< static features in the newest frame whose position is known
  int inliers = 0;         ///< of those, with a small reprojection error
  double sigma_m = 1e3;    ///< standard deviation of the position along its least certain direction
  double sigma_rad = 1e3;  ///< same for the rotation
  /// Of the camera pose, see `UncertainPose`; zero if the inliers leave a direction undetermined.
  Matrix6 covariance = Matrix6::Zero();

  /// At least eight inliers, and three tenths of all, or one tenth if inertial data agree with the pose,
  /// because the others may belong to moving objects: otherwise the pose is not that of the camera.
  [[nodiscard]] bool is_located(bool inertial) const;
  /// Located by few features, or with an uncertain direction.
  [[nodiscard]] bool has_few_features() const;
  [[nodiscard]] bool has_weak_geometry() const;
  /// Whether the pose may contradict inertial data: it is well determined, and seven tenths of the features
  /// agree with it, which are at least a quarter of all tracked ones. Behind a person who just came before
  /// the camera few features of known position remain, and some of those are on the person.
  /// @param tracked number of features in the newest frame
  [[nodiscard]] bool may_contradict_imu(int tracked) const;
};

/// Camera pose with its covariance, in the frame of the camera. The standard deviation of the bearings
/// follows from their residuals, because the positions of the points have errors, too: for n inliers
///
///   s^2 = max(bearing_sigma^2, sum_k |r_k|^2 / (2 n - 6)).
/// @param bearing_sigma claimed standard deviation of a bearing
/// @param threshold     of inliers [normalized image plane]
/// @return nothing if fewer than four inliers remain, or if they leave a direction undetermined
[[nodiscard]] std::optional<UncertainPose> with_covariance(const std::vector<PointObservation>& points,
                                                           const Pose& T_w_c, double bearing_sigma,
                                                           double threshold);

/// How many points agree with a pose: with the errors e of their bearings,
///
///   sum over the points of max(0, 1 - (e / threshold)^2).
[[nodiscard]] double support(const std::vector<PointObservation>& points, const Pose& T_w_c,
                             double threshold);

/// @param bearing_sigma standard deviation s of a bearing; inliers are within five times of it
[[nodiscard]] VisionAssessment assess_vision(const std::vector<PointObservation>& points, const Pose& T_w_c,
                                             double bearing_sigma);

/// Of the static landmarks that are observed in the newest frame and whose depth was estimated before, at the
/// predicted camera pose. With P of that pose, and the standard deviation s of a residual, the difference of
/// the bearings u in this and in the host frame (see `BackendConfig::pixel_sigma_px`),
///
///   v = u - pi(T_w_c^-1 p_w),    S = J P J^T + s^2 I,    see `projection_covariance`.
///
/// Landmarks that move unrecognized hardly change it: it is the median of v^T S^-1 v over the landmarks,
/// divided by that of the chi-square distribution with two degrees of freedom.
/// @param residual_sigma s [normalized image plane]
/// @param distances buffer, whose content is ignored: v^T S^-1 v of each landmark
/// @return nothing if there are fewer than eight landmarks
[[nodiscard]] std::optional<double> reprojection_nis(const Window& window, const UncertainPose& camera,
                                                     double residual_sigma, std::vector<double>& distances);

/// Of a pose by vision alone, at the pose predicted by inertial data: the squared distance by the sum of both
/// covariances, divided by 6.
[[nodiscard]] double inertial_nis(const UncertainPose& predicted, const UncertainPose& visual);

}  // namespace stillpoint
