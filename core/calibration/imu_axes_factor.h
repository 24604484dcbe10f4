// SPDX-License-Identifier: BSD-3-Clause
/// Scale and misalignment of the axes of the inertial sensors in the batch estimation of the calibration.
#pragma once

#include <array>

#include <Eigen/Core>

#include <ceres/sized_cost_function.h>

#include "core/backend/reference/state_factors.h"
#include "core/imu/preintegration.h"
#include "core/types/rig.h"

namespace stillpoint {

/// Of the gyroscope, then of the accelerometer: the relative scales x, y, z, and the angles xy, xz, yz [rad],
/// by which the first axis measures what is along the second one.
inline constexpr int kImuAxesCount = 12;
using ImuAxesValues = std::array<double, kImuAxesCount>;

/// I + U of both sensors, with U the upper triangular matrix of the values.
[[nodiscard]] ImuAxes axes_of(const ImuAxesValues& values);

/// Derivatives of the preintegrated deltas (ImuErrorIndex; those of the biases are zero) by the values, from
/// integrations with changed ones.
using ImuAxesJacobian = Eigen::Matrix<double, 15, kImuAxesCount>;

/// @param imu of samples that were corrected by `values`
[[nodiscard]] ImuAxesJacobian imu_axes_jacobian(const Preintegration& imu, const ImuNoise& noise,
                                                const ImuAxesValues& values);

/// ImuFactor with the axes as another parameter block u, whose samples were corrected by u_0. To first order,
/// with W and J of Preintegration and imu_axes_jacobian:
///
///   r(x, u) = r(x) - W J (u - u_0)
class ImuAxesFactor final : public ceres::SizedCostFunction<15, 7, 9, 7, 9, 3, 1, kImuAxesCount> {
 public:
  /// Where the derivatives by the axes are taken.
  struct Linearization {
    ImuAxesJacobian jacobian = ImuAxesJacobian::Zero();
    ImuAxesValues values{};  ///< u_0
  };

  /// @param imu must outlive the factor; of positive duration
  ImuAxesFactor(const Preintegration& imu, const TimedImuResidual::Ends& ends, const Linearization& at)
      : factor_(imu, ends), weighted_(-imu.sqrt_information() * at.jacobian), values_(at.values) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  ImuFactor factor_;
  Eigen::Matrix<double, 15, kImuAxesCount, Eigen::RowMajor> weighted_;  ///< -W J
  ImuAxesValues values_;
};

}  // namespace stillpoint
