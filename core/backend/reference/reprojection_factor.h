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
  Eigen::Vector2d velocity_i = Eigen::Vector2d::Zero();  ///< of the bearing [1/s]
  Eigen::Vector2d velocity_j = Eigen::Vector2d::Zero();
  double exposure_i_s = 0.0;  ///< row readout offset minus the time offset at which state i is defined
  double exposure_j_s = 0.0;
  double inverse_depth_j = 0.0;  ///< measured in j [1/m]; used by the depth row only
};

/// Two rows of bearing error and, with `Rows == 3`, one of inverse depth. Qin et al. 2018, Eq. (25), on the
/// normalized image plane instead of the unit sphere. With the bearings u_i, u_j and their velocities, td the
/// time offset, e_k the row readout offset minus the time offset at which state k is defined, s the depth
/// scale (ratio of measured to true depth), and lambda the inverse depth in the host:
///
///   u_k(td) = u_k - (td + e_k) du_k/dt,  k = i, j         (shifted to the time of the state)
///   P       = T_c_b T_bj_w T_w_bi T_b_c [u_i(td); 1; lambda]
///   r_u     = (P_xy / P_z - u_j(td)) / sigma_u
///   r_d     = rho((lambda / (s P_z) - lambda_j) / sigma_d),   rho(d) = d / sqrt(1 + (d/c)^2)
///
/// P is homogeneous: lambda times the point in camera j.
/// lambda_j is the inverse depth measured in j; lambda / P_z is the true one. The scale divides the
/// prediction: a factor on the measurement would scale its noise, and the cost would decrease with it. The
/// bounded rho (Geman & McClure 1985) keeps a depth measured across an object's edge from outweighing the
/// bearing.
///
/// Scaling the point by lambda removes the pole at infinity: the residual is defined for every inverse depth,
/// including zero and negative values, and for points behind camera j. One outlier therefore cannot make the
/// solver reject a step.
///
/// Parameter blocks: pose i, pose j, T_b_c (p, q xyzw each), td, with `Rows == 3` s, lambda. The derivative
/// of the relative pose of the cameras is evaluated with the first estimates in place of the poses, where
/// given; the residual is not.
template <int Rows>
class ReprojectionFactor final
    : public std::conditional_t<Rows == 3, ceres::SizedCostFunction<3, 7, 7, 7, 1, 1, 1>,
                                ceres::SizedCostFunction<2, 7, 7, 7, 1, 1>> {
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

/// Depth measured in the host: r = rho((lambda / s - lambda_i) / sigma_d), with rho as above. Parameter
/// blocks: s, lambda.
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
