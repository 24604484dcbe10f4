// SPDX-License-Identifier: BSD-3-Clause
#include "core/imu/preintegration.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "core/geometry/so3.h"
#include "tests/unit/imu/motions.h"

namespace stillpoint {
namespace {

using Index = ImuErrorIndex;
const Eigen::Vector3d kZero = Eigen::Vector3d::Zero();
const Eigen::Vector3d kGyroBias(0.02, -0.01, 0.03);
const Eigen::Vector3d kAccelBias(0.1, 0.2, -0.15);

Preintegration integrated(const std::vector<ImuSample>& samples, const Eigen::Vector3d& gyro_bias = kZero,
                          const Eigen::Vector3d& accel_bias = kZero) {
  Preintegration imu(ImuNoise{}, gyro_bias, accel_bias);
  imu.integrate(samples);
  return imu;
}

/// The deltas as one vector (p, theta, v), theta relative to `q_reference`.
Eigen::Matrix<double, 9, 1> deltas(const Preintegration& imu, const Eigen::Quaterniond& q_reference) {
  Eigen::Matrix<double, 9, 1> all;
  all.segment<3>(0) = imu.delta_p(imu.gyro_bias(), imu.accel_bias());
  all.segment<3>(3) = log_so3(q_reference.conjugate() * imu.delta_q(imu.gyro_bias()));
  all.segment<3>(6) = imu.delta_v(imu.gyro_bias(), imu.accel_bias());
  return all;
}

void expect_same(const Preintegration& a, const Preintegration& b, double tolerance) {
  const Eigen::Quaterniond q = a.delta_q(a.gyro_bias());
  EXPECT_LT((deltas(a, q) - deltas(b, q)).norm(), tolerance);
  EXPECT_LT((a.covariance() - b.covariance()).norm(), tolerance * a.covariance().norm());
  EXPECT_LT((a.jacobian() - b.jacobian()).norm(), tolerance * a.jacobian().norm());
  EXPECT_NEAR(a.duration_s(), b.duration_s(), tolerance);
}

TEST(Preintegration, ConstantRateGivesAConstantRotation) {
  const Eigen::Vector3d rate(0.4, -0.3, 0.5);
  const Preintegration imu =
      integrated(sample_motion(2.0, 100.0, [&](double) { return ImuSample{.t = {}, .gyro_b = rate}; }));
  EXPECT_LT(log_so3(exp_so3(2.0 * rate).conjugate() * imu.delta_q(kZero)).norm(), 1e-12);
  EXPECT_NEAR(imu.duration_s(), 2.0, 1e-12);
}

TEST(Preintegration, ConstantForceGivesParabolicMotion) {
  const Eigen::Vector3d force(1.0, -2.0, 9.0);
  const Preintegration imu =
      integrated(sample_motion(2.0, 100.0, [&](double) { return ImuSample{.t = {}, .accel_b = force}; }));
  EXPECT_LT((imu.delta_v(kZero, kZero) - 2.0 * force).norm(), 1e-11);  // a t
  EXPECT_LT((imu.delta_p(kZero, kZero) - 2.0 * force).norm(), 1e-11);  // a t^2 / 2, t = 2
}

TEST(Preintegration, PredictsCircularMotion) {
  const Circle circle;
  const Preintegration imu = integrated(sample_motion(3.0, 200.0, [&](double) { return circle.imu(); }));
  const NavState end = imu.predict(circle.state(0.0), kGravity);
  const NavState truth = circle.state(3.0);
  // Trapezoidal rule: the mean force of a step has an error of a (w dt)^2 / 12, so the velocity of up to
  // 3 s * 4.5 m/s^2 * (1.5 / 200)^2 / 12 = 6.4e-5 m/s; the position of its integral, 9.5e-5 m, plus
  // a' dt^3 / 12 per step, 3 s * 6.75 m/s^3 * (1 / 200)^2 / 12 = 4.2e-5 m.
  EXPECT_LT((end.v_w - truth.v_w).norm(), 6.4e-5);
  EXPECT_LT((end.T_w_b.p - truth.T_w_b.p).norm(), 1.4e-4);
  EXPECT_LT(end.T_w_b.q.angularDistance(truth.T_w_b.q), 1e-12);
  EXPECT_EQ(end.t, truth.t);
}

TEST(Preintegration, SubtractsTheBiases) {
  std::vector<ImuSample> biased = rich_motion_samples(1.0);
  for (ImuSample& sample : biased) {
    sample.gyro_b += kGyroBias;
    sample.accel_b += kAccelBias;
  }
  expect_same(integrated(rich_motion_samples(1.0)), integrated(biased, kGyroBias, kAccelBias), 1e-12);
}

TEST(Preintegration, BiasJacobianMatchesCentralDifferences) {
  const std::vector<ImuSample> samples = rich_motion_samples(0.5);
  const Preintegration imu = integrated(samples, kGyroBias, kAccelBias);
  const Eigen::Quaterniond q = imu.delta_q(kGyroBias);
  constexpr double kStep = 1e-5;  // second-order error ~ step^2, rounding ~ 1e-16 / step
  for (int axis = 0; axis < 6; ++axis) {
    Eigen::Matrix<double, 6, 1> change = Eigen::Matrix<double, 6, 1>::Zero();
    change(axis) = kStep;
    const Preintegration up =
        integrated(samples, kGyroBias + change.head<3>(), kAccelBias + change.tail<3>());
    const Preintegration down =
        integrated(samples, kGyroBias - change.head<3>(), kAccelBias - change.tail<3>());
    const Eigen::Matrix<double, 9, 1> numeric = (deltas(up, q) - deltas(down, q)) / (2.0 * kStep);
    EXPECT_LT((imu.jacobian().col(Index::kGyroBias + axis).head<9>() - numeric).norm(), 1e-8) << axis;
  }
}

TEST(Preintegration, StateJacobianTransformsTheDeltas) {
  const std::vector<ImuSample> samples = rich_motion_samples(0.5);
  const Preintegration imu = integrated(samples);
  // An attitude error theta at i changes the deltas to Exp(theta) * delta; to first order p changes by theta
  // x p, and the right perturbation of q is R^T theta. A velocity error v adds v T to p. Second order:
  // |theta|^2 / 2 * 5 m/s = 2e-13.
  const Eigen::Vector3d theta(1e-7, -2e-7, 1.5e-7);
  const Eigen::Quaterniond rotation = exp_so3(theta);
  const Eigen::Matrix<double, 9, 3> J = imu.jacobian().block<9, 3>(0, Index::kRotation);
  const Eigen::Vector3d p = imu.delta_p(kZero, kZero);
  const Eigen::Vector3d v = imu.delta_v(kZero, kZero);
  const Eigen::Quaterniond q = imu.delta_q(kZero);
  EXPECT_LT((J.topRows<3>() * theta - (rotation * p - p)).norm(), 1e-12);
  EXPECT_LT((J.middleRows<3>(3) * theta - log_so3(q.conjugate() * rotation * q)).norm(), 1e-12);
  EXPECT_LT((J.bottomRows<3>() * theta - (rotation * v - v)).norm(), 1e-12);
  const Eigen::Matrix3d p_by_v = imu.jacobian().block<3, 3>(Index::kPosition, Index::kVelocity);
  EXPECT_LT((p_by_v - 0.5 * Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(Preintegration, FirstOrderCorrectionMatchesASmallBiasChange) {
  const std::vector<ImuSample> samples = rich_motion_samples(0.5);
  const Preintegration imu = integrated(samples);
  const Preintegration truth = integrated(samples, kGyroBias, kAccelBias);
  // Second order: (|bias| T)^2 = (0.037 * 0.5)^2 = 3.4e-4, times |delta_p| ~ 1.2 m, |delta_v| ~ 4.7 m/s.
  EXPECT_LT(imu.delta_q(kGyroBias).angularDistance(truth.delta_q(kGyroBias)), 3.4e-4);
  EXPECT_LT((imu.delta_p(kGyroBias, kAccelBias) - truth.delta_p(kGyroBias, kAccelBias)).norm(), 4e-4);
  EXPECT_LT((imu.delta_v(kGyroBias, kAccelBias) - truth.delta_v(kGyroBias, kAccelBias)).norm(), 1.6e-3);
}

TEST(Preintegration, RepropagationEqualsIntegrationWithTheNewBiases) {
  const std::vector<ImuSample> samples = rich_motion_samples(0.5);
  Preintegration imu = integrated(samples);
  imu.repropagate(kGyroBias, kAccelBias);
  expect_same(integrated(samples, kGyroBias, kAccelBias), imu, 1e-15);
}

TEST(Preintegration, ExtendingAnIntervalEqualsASingleIntegration) {
  const std::vector<ImuSample> samples = rich_motion_samples(1.0);
  const std::vector<ImuSample> first(samples.begin(), samples.begin() + 81);
  const std::vector<ImuSample> second(samples.begin() + 80, samples.end());
  Preintegration imu = integrated(first);
  imu.integrate(second);
  expect_same(integrated(samples), imu, 1e-15);
  EXPECT_EQ(imu.samples().size(), samples.size());
}

TEST(Preintegration, TheInformationOfASingleStepIsThatOfContinuousWhiteNoise) {
  constexpr double dt = 0.03;
  std::vector<ImuSample> samples(2,
                                 ImuSample{.t = {}, .gyro_b = {0.3, -0.2, 0.1}, .accel_b = {0.5, 1.0, 9.8}});
  samples[1].t = from_seconds(dt);
  const Preintegration imu = integrated(samples);
  const Matrix15& W = imu.sqrt_information();
  const Matrix15 P = (W.transpose() * W).inverse();
  const double density = ImuNoise{}.accel_noise;
  EXPECT_NEAR(P(Index::kPosition, Index::kPosition), density * density * dt * dt * dt / 3.0, 1e-3 * P(0, 0));
  EXPECT_LT(W.cwiseAbs().maxCoeff(), 1e7);
}

TEST(Preintegration, WithoutNoiseDensitiesThereIsNoInformation) {
  Preintegration imu(ImuNoise{0.0, 0.0, 0.0, 0.0}, kZero, kZero);
  imu.integrate(rich_motion_samples(0.1));
  EXPECT_EQ(imu.sqrt_information(), Matrix15::Zero());
}

TEST(Preintegration, ASingleSampleGivesNoMotion) {
  const Preintegration imu = integrated({ImuSample{.t = {}, .gyro_b = {1.0, 1.0, 1.0}}});
  EXPECT_EQ(imu.duration_s(), 0.0);
  EXPECT_EQ(imu.covariance(), Matrix15::Zero());
  EXPECT_EQ(imu.jacobian(), Matrix15::Identity());
}

TEST(Preintegration, HasTheLargerRandomWalkOfBothIntervalsAfterAnAppend) {
  const ImuNoise small{.gyro_walk = 1e-5, .accel_walk = 1e-4}, large{.gyro_walk = 1e-2, .accel_walk = 1e-1};
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const auto samples = [](int first, int last) {
    std::vector<ImuSample> found;
    for (int i = first; i <= last; ++i)
      found.push_back({after(Timestamp{}, 0.005 * i), {0.1, 0.5, -0.2}, {0.3, 0.2, 9.9}});
    return found;
  };
  Preintegration earlier(small, zero, zero), later(large, zero, zero), both(large, zero, zero);
  earlier.integrate(samples(0, 10));
  later.integrate(samples(10, 20));
  both.integrate(samples(0, 20));
  earlier.append(later);
  EXPECT_TRUE(earlier.covariance().isApprox(both.covariance(), 1e-12));
}

}  // namespace
}  // namespace stillpoint
