// SPDX-License-Identifier: BSD-3-Clause
/// The IMU residual with gravity and the time offset among its parameter blocks.
#pragma once

#include <array>

#include "core/backend/factors/exposure_shift.h"
#include "core/backend/factors/imu_residual.h"

namespace stillpoint {

/// ImuResidual of states at the exposures of two frames, which are shifted to the ends of the preintegration
/// (see ExposureShift).
///
/// Parameter blocks: those of ImuResidual, gravity, time offset. Jacobians are row-major with 7, 9, 7, 9, 3
/// and 1 columns; those of poses and gravity hold the tangent space in the first six and two columns.
class TimedImuResidual {
 public:
  using Ends = std::array<ImuEnd, 2>;

  /// @param imu must outlive the residual; of positive duration
  /// @param ends of the preintegration; null if the states are defined there: then the time offset has no
  /// influence
  TimedImuResidual(const Preintegration& imu, const Ends* ends) : imu_(imu), ends_(ends) {}

  /// Writes the residual, 15 values, and the Jacobians.
  /// @param jacobians null = none; a null pointer among them skips one
  void evaluate(double const* const* parameters, double* residuals, double** jacobians) const;

 private:
  void evaluate_shifted(double const* const* parameters, double* residuals, double** jacobians) const;

  const Preintegration& imu_;
  const Ends* ends_;
};

}  // namespace stillpoint
