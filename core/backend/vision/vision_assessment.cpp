// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/vision/vision_assessment.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/config/monitor_config.h"
#include "core/geometry/covariance.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

/// Information H of the inliers about T_c_w, perturbed on the left.
struct BearingInformation {
  int inliers = 0;
  Matrix6 H = Matrix6::Zero();
  double squared_error = 0.0;  ///< sum over the inliers, in units of the variance of a bearing

  /// Of the camera pose T_w_c; absent if the inliers leave a direction undetermined. T_c_w = (Exp(phi), rho)
  /// T_c_w' moves the camera by -R_w_c rho and turns it by -phi in its own frame.
  [[nodiscard]] std::optional<Matrix6> covariance(const Pose& T_w_c) const {
    const Eigen::FullPivLU<Matrix6> factor(H);
    if (inliers < 3 || !factor.isInvertible()) return std::nullopt;
    Matrix6 J = Matrix6::Identity();
    J.topLeftCorner<3, 3>() = T_w_c.R();
    return propagate(J, Matrix6(factor.inverse()));
  }
};

BearingInformation bearing_information(const std::vector<PointObservation>& points, const Pose& T_w_c,
                                       double bearing_sigma) {
  BearingInformation information;
  const Pose T_c_w = T_w_c.inverse();
  for (const PointObservation& point : points) {
    const Eigen::Vector3d p_c = T_c_w * point.p_w;
    if (p_c.z() < kMonitor.vision.min_depth_m) continue;
    const Eigen::Vector2d projected = p_c.hnormalized();
    const double error = (projected - point.bearing).norm();
    if (!(error <= kMonitor.vision.inlier_sigmas * bearing_sigma)) continue;
    ++information.inliers;
    information.squared_error += std::pow(error / bearing_sigma, 2);
    Eigen::Matrix<double, 2, 3> J_point;
    J_point << 1.0, 0.0, -projected.x(), 0.0, 1.0, -projected.y();
    J_point /= p_c.z() * bearing_sigma;
    Eigen::Matrix<double, 2, 6> J;
    J << J_point, -J_point * skew(p_c);
    information.H.noalias() += J.transpose() * J;
  }
  return information;
}

}  // namespace

bool VisionAssessment::is_located(bool inertial) const {
  return inliers >= kMonitor.vision.min_inliers &&
         inliers >=
             (inertial ? kMonitor.vision.min_inertial_inlier_ratio : kMonitor.vision.min_inlier_ratio) *
                 features;
}

bool VisionAssessment::has_few_features() const { return inliers < kMonitor.vision.few_inliers; }

bool VisionAssessment::has_weak_geometry() const {
  return !(sigma_m < kMonitor.vision.weak_m && sigma_rad < kMonitor.vision.weak_rad);
}

VisionAssessment assess_vision(const std::vector<PointObservation>& points, const Pose& T_w_c,
                               double bearing_sigma) {
  const BearingInformation information = bearing_information(points, T_w_c, bearing_sigma);
  VisionAssessment assessment{.features = static_cast<int>(points.size()), .inliers = information.inliers};
  const std::optional<Matrix6> covariance = information.covariance(T_w_c);
  if (!covariance) return assessment;
  assessment.covariance = *covariance;
  assessment.sigma_m = largest_sigma(covariance->topLeftCorner<3, 3>());
  assessment.sigma_rad = largest_sigma(covariance->bottomRightCorner<3, 3>());
  return assessment;
}

std::optional<UncertainPose> with_covariance(const std::vector<PointObservation>& points, const Pose& T_w_c,
                                             double bearing_sigma, double threshold) {
  const double sigma = threshold / kMonitor.vision.inlier_sigmas;
  const BearingInformation information = bearing_information(points, T_w_c, sigma);
  const std::optional<Matrix6> covariance = information.covariance(T_w_c);
  if (!covariance || information.inliers <= 3) return std::nullopt;
  const double variance = std::max(std::pow(bearing_sigma / sigma, 2),
                                   information.squared_error / (2.0 * information.inliers - 6.0));
  return UncertainPose{T_w_c, variance * *covariance};
}

double support(const std::vector<PointObservation>& points, const Pose& T_w_c, double threshold) {
  const Pose T_c_w = T_w_c.inverse();
  double sum = 0.0;
  for (const PointObservation& point : points) {
    const Eigen::Vector3d p_c = T_c_w * point.p_w;
    if (p_c.z() < kMonitor.vision.min_depth_m) continue;
    sum += std::max(0.0, 1.0 - ((p_c.hnormalized() - point.bearing) / threshold).squaredNorm());
  }
  return sum;
}

bool VisionAssessment::may_contradict_imu(int tracked) const {
  return !has_few_features() && !has_weak_geometry() &&
         inliers >= kMonitor.vision.min_agreeing_ratio * features &&
         inliers >= kMonitor.vision.min_known_ratio * tracked;
}

namespace {

const double kMedianOfChiSquare2 = 2.0 * std::log(2.0);

}  // namespace

std::optional<double> reprojection_nis(const Window& window, const UncertainPose& camera,
                                       double residual_sigma, std::vector<double>& distances) {
  const Pose T_c_w = camera.T_w_f.inverse();
  distances.clear();
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.dynamic || landmark.last() != window.newest() || landmark.host == window.newest() ||
        landmark.inverse_depth <= 0.0) {
      continue;
    }
    const Eigen::Vector3d p_c = T_c_w * window.position(landmark, landmark.inverse_depth);
    if (p_c.z() < kMonitor.vision.min_depth_m) continue;
    const Eigen::Vector2d v = landmark.observations.back().bearing - p_c.hnormalized();
    const Eigen::Matrix2d S =
        projection_covariance(camera, p_c) + residual_sigma * residual_sigma * Eigen::Matrix2d::Identity();
    distances.push_back(v.dot(S.inverse() * v));
  }
  if (static_cast<int>(distances.size()) < kMonitor.innovation.min_landmarks) return std::nullopt;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::ranges::nth_element(distances, middle);
  return *middle / kMedianOfChiSquare2;
}

double inertial_nis(const UncertainPose& predicted, const UncertainPose& visual) {
  return squared_distance(predicted.T_w_f, visual.T_w_f, predicted.covariance + visual.covariance) / 6.0;
}

}  // namespace stillpoint
