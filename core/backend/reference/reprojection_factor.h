// SPDX-License-Identifier: BSD-3-Clause
/// Reprojection residual of a landmark between its host frame and another frame, optionally with a depth row.
#pragma once

#include <array>
#include <type_traits>

#include <ceres/sized_cost_function.h>
#include <Eigen/Core>

#include "core/backend/factors/reprojection_rows.h"

namespace stillpoint {

/// Observations of one landmark in its host frame i and in frame j.
struct ReprojectionMeasurement {
  Eigen::Vector2d bearing_i = Eigen::Vector2d::Zero();  ///< normalized image plane
  Eigen::Vector2d bearing_j = Eigen::Vector2d::Zero();
  Eigen::Vector2d seen_i = Eigen::Vector2d::Zero();  ///< by the camera of the rig
  Eigen::Vector2d seen_j = Eigen::Vector2d::Zero();
  Eigen::Vector4d lens = Eigen::Vector4d::Zero();        ///< with which the bearings were corrected
  Eigen::Vector2d velocity_i = Eigen::Vector2d::Zero();  ///< of the bearing [1/s]
  Eigen::Vector2d velocity_j = Eigen::Vector2d::Zero();
  double exposure_i_s = 0.0;  ///< row readout offset minus the time offset at which state i is defined
  double exposure_j_s = 0.0;
  double inverse_depth_j = 0.0;  ///< measured in j [1/m]; used by the depth row only
};

/// The residual of reprojection_rows.h: two rows of bearing error and, with `Rows == 3`, one of inverse
/// depth.
///
/// Parameter blocks: pose i, pose j, T_b_c (p, q xyzw each), td, c, with `Rows == 3` k, lambda. The
/// derivative of the relative pose of the cameras is evaluated with the first estimates in place of the
/// poses, where given; the residual is not.
template <int Rows>
class ReprojectionFactor final
    : public std::conditional_t<Rows == 3, ceres::SizedCostFunction<3, 7, 7, 7, 1, 4, 1, 1>,
                                ceres::SizedCostFunction<2, 7, 7, 7, 1, 4, 1>> {
  static_assert(Rows == 2 || Rows == 3);

 public:
  /// First estimates of pose i, pose j and T_b_c, or null.
  using FirstEstimates = std::array<const double*, 3>;

  ReprojectionFactor(const ReprojectionMeasurement& measurement, const ReprojectionNoise& noise,
                     const FirstEstimates& first = {})
      : measurement_(measurement), noise_(noise), first_(first) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  ReprojectionMeasurement measurement_;
  ReprojectionNoise noise_;
  FirstEstimates first_;
};

extern template class ReprojectionFactor<2>;
extern template class ReprojectionFactor<3>;

/// Depth measured in the host: r = rho((k lambda - lambda_i) / sigma_d), with rho as above. Parameter
/// blocks: k, lambda.
class HostDepthFactor final : public ceres::SizedCostFunction<1, 1, 1> {
 public:
  HostDepthFactor(double measured_inverse_depth, const ReprojectionNoise& noise)
      : measured_(measured_inverse_depth), noise_(noise) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  double measured_;
  ReprojectionNoise noise_;
};

}  // namespace stillpoint
