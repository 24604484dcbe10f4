// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/vision_assessment.h"

#include <Eigen/LU>

#include "core/geometry/covariance.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr int kMinInliers = 8;
constexpr double kMinVisualInlierRatio = 0.3;
constexpr double kMinInertialInlierRatio = 0.1;
constexpr int kFewInliers = 15;
constexpr double kWeak_m = 0.1;
constexpr double kWeak_rad = 0.05;
constexpr double kMaxBearingError_sigmas = 5.0;
constexpr double kMinPointDepth = 0.05;  // [m]

using Matrix6 = Eigen::Matrix<double, 6, 6>;

}  // namespace

bool VisionAssessment::is_located(bool inertial) const {
  return inliers >= kMinInliers &&
         inliers >= (inertial ? kMinInertialInlierRatio : kMinVisualInlierRatio) * features;
}

bool VisionAssessment::has_few_features() const { return inliers < kFewInliers; }

bool VisionAssessment::has_weak_geometry() const { return !(sigma_m < kWeak_m && sigma_rad < kWeak_rad); }

VisionAssessment assess_vision(const std::vector<PointObservation>& points, const Pose& T_w_c,
                               double bearing_sigma) {
  VisionAssessment assessment{.features = static_cast<int>(points.size())};
  const Pose T_c_w = T_w_c.inverse();
  Matrix6 H = Matrix6::Zero();
  for (const PointObservation& point : points) {
    const Eigen::Vector3d p_c = T_c_w * point.p_w;
    if (p_c.z() < kMinPointDepth) continue;
    const Eigen::Vector2d projected = p_c.hnormalized();
    if (!((projected - point.bearing).norm() <= kMaxBearingError_sigmas * bearing_sigma)) continue;
    ++assessment.inliers;
    Eigen::Matrix<double, 2, 3> J_point;
    J_point << 1.0, 0.0, -projected.x(), 0.0, 1.0, -projected.y();
    J_point /= p_c.z() * bearing_sigma;
    Eigen::Matrix<double, 2, 6> J;
    J << J_point, -J_point * skew(p_c);
    H.noalias() += J.transpose() * J;
  }
  const Eigen::FullPivLU<Matrix6> factor(H);
  if (assessment.inliers < 3 || !factor.isInvertible()) return assessment;
  const Matrix6 covariance = factor.inverse();
  assessment.sigma_m = largest_sigma(covariance.topLeftCorner<3, 3>());
  assessment.sigma_rad = largest_sigma(covariance.bottomRightCorner<3, 3>());
  return assessment;
}

}  // namespace stillpoint
