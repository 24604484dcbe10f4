// SPDX-License-Identifier: BSD-3-Clause
#include "core/calibration/imu_axes_factor.h"

#include <algorithm>
#include <vector>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr double kAxesStep = 1e-5;  // of the differences; the deltas are smooth

Eigen::Matrix3d upper_triangular(const double* v) {
  Eigen::Matrix3d A;
  A << 1.0 + v[0], v[3], v[4], 0.0, 1.0 + v[1], v[5], 0.0, 0.0, 1.0 + v[2];
  return A;
}

}  // namespace

ImuAxes axes_of(const ImuAxesValues& values) {
  return {upper_triangular(values.data()), upper_triangular(values.data() + kImuAxesCount / 2)};
}

ImuAxesJacobian imu_axes_jacobian(const Preintegration& imu, const ImuNoise& noise,
                                  const ImuAxesValues& values) {
  const Eigen::Vector3d &gyro_bias = imu.gyro_bias(), &accel_bias = imu.accel_bias();
  const ImuAxes at = axes_of(values);
  ImuAxesJacobian jacobian = ImuAxesJacobian::Zero();
  for (int k = 0; k < kImuAxesCount; ++k) {
    ImuAxesValues changed = values;
    changed[static_cast<std::size_t>(k)] += kAxesStep;
    ImuAxes change = axes_of(changed);  // relative to `at`
    change = {at.gyro.inverse() * change.gyro, at.accel.inverse() * change.accel};
    std::vector<ImuSample> samples = imu.samples();
    std::ranges::transform(samples, samples.begin(),
                           [&](const ImuSample& sample) { return change.corrected(sample); });
    Preintegration other(noise, gyro_bias, accel_bias);
    other.integrate(samples);
    auto column = jacobian.col(k);
    column.segment<3>(ImuErrorIndex::kPosition) =
        (other.delta_p(gyro_bias, accel_bias) - imu.delta_p(gyro_bias, accel_bias)) / kAxesStep;
    column.segment<3>(ImuErrorIndex::kRotation) =
        log_so3(imu.delta_q(gyro_bias).conjugate() * other.delta_q(gyro_bias)) / kAxesStep;
    column.segment<3>(ImuErrorIndex::kVelocity) =
        (other.delta_v(gyro_bias, accel_bias) - imu.delta_v(gyro_bias, accel_bias)) / kAxesStep;
  }
  return jacobian;
}

bool ImuAxesFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  if (!factor_.Evaluate(parameters, residuals, jacobians)) return false;
  using Values = Eigen::Matrix<double, kImuAxesCount, 1>;
  const Eigen::Map<const Values> values(parameters[6]), from(values_.data());
  Eigen::Map<Vector15>{residuals} += weighted_ * (values - from);
  if (jacobians != nullptr && jacobians[6] != nullptr)
    Eigen::Map<Eigen::Matrix<double, 15, kImuAxesCount, Eigen::RowMajor>>{jacobians[6]} = weighted_;
  return true;
}

}  // namespace stillpoint
