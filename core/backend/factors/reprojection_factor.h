// SPDX-License-Identifier: BSD-3-Clause
/// Residual between where a landmark's host says it is and where, and how deep, another frame saw it.
#pragma once

#include <ceres/sized_cost_function.h>
#include <Eigen/Core>

#include "core/backend/factors/reprojection_rows.h"

namespace stillpoint {

/// One landmark seen by its host i and by frame j.
struct ReprojectionMeasurement {
  Eigen::Vector2d bearing_i = Eigen::Vector2d::Zero();  ///< normalised plane
  Eigen::Vector2d bearing_j = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_i = Eigen::Vector2d::Zero();  ///< of the bearing [1/s]
  Eigen::Vector2d velocity_j = Eigen::Vector2d::Zero();
  double exposure_i_s = 0.0;  ///< exposure of the observation minus the time of state i, less the time offset
  double exposure_j_s = 0.0;
  double inverse_depth_j = 0.0;  ///< measured in j [1/m]; read by the depth row only
};

/// Two rows of bearing error and, with `Rows == 3`, one of inverse depth. Blocks: pose i, pose j, camera in
/// body (p, q xyzw each), time offset, inverse depth in the host. Qin et al. 2018, Eq. (25), in the
/// normalised plane.
///
/// The depth row is bounded, d / sqrt(1 + (d/c)^2) (Geman & McClure 1985): one depth on an object's edge must
/// not cost the landmark its good bearing.
///
/// Defined for every inverse depth, zero and negative ones too, and for points behind camera j: a step of the
/// solver that throws one bad point beyond infinity must not be refused for all the others.
template <int Rows>
class ReprojectionFactor final : public ceres::SizedCostFunction<Rows, 7, 7, 7, 1, 1> {
  static_assert(Rows == 2 || Rows == 3);

 public:
  ReprojectionFactor(const ReprojectionMeasurement& measurement, const ReprojectionNoise& noise)
      : measurement_(measurement), noise_(noise) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  ReprojectionMeasurement measurement_;
  ReprojectionNoise noise_;
};

extern template class ReprojectionFactor<2>;
extern template class ReprojectionFactor<3>;

/// Depth measured by the host itself: (inverse depth - measured) / sigma, bounded in the same way.
class HostDepthFactor final : public ceres::SizedCostFunction<1, 1> {
 public:
  HostDepthFactor(double measured_inverse_depth, const ReprojectionNoise& noise)
      : measured_(measured_inverse_depth), noise_(noise) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  double measured_;
  ReprojectionNoise noise_;
};

}  // namespace stillpoint
