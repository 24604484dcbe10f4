// SPDX-License-Identifier: BSD-3-Clause
// Compares the preintegrated rotation of recorded sequences with motion capture. The ground truth of both is
// that of the IMU body. Residual offsets were estimated once: the error is minimal at a time offset of 0 ms
// (+-1 ms) in both, and the best constant rotation between the bodies is 0.16 degrees (V1_03) and 0.05
// degrees (room1), so neither is corrected here.
#include <algorithm>
#include <iostream>

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "core/imu/preintegration.h"
#include "tests/support/test_data.h"
#include "tests/unit/imu/real_rotation.h"

namespace stillpoint {
namespace {

constexpr double kWindow = 0.5;    // [s]
constexpr double kBiasSpan = 5.0;  // [s] at the start, used to estimate the bias
constexpr double kToDegrees = 180.0 / M_PI;
const Eigen::Vector3d kZero = Eigen::Vector3d::Zero();

/// Gyro bias estimated from the windows in two iterations (see `estimate_gyro_bias`).
Eigen::Vector3d gyro_bias_of(std::span<const RotationWindow> windows) {
  Eigen::Vector3d bias = kZero;
  for (int round = 0; round < 2; ++round) {
    std::vector<Preintegration> preintegrations;
    for (const RotationWindow& window : windows) {
      preintegrations.emplace_back(ImuNoise{}, bias, kZero).integrate(window.samples);
    }
    std::vector<RotationPair> pairs;
    for (std::size_t i = 0; i < windows.size(); ++i) {
      pairs.push_back({&preintegrations[i], windows[i].q_bi_bj});
    }
    bias = estimate_gyro_bias(pairs);
  }
  return bias;
}

double rotation_rmse_deg(std::span<const RotationWindow> windows, const Eigen::Vector3d& gyro_bias) {
  double sum = 0.0;
  for (const RotationWindow& window : windows) {
    Preintegration imu(ImuNoise{}, gyro_bias, kZero);
    imu.integrate(window.samples);
    sum += log_so3(imu.delta_q(gyro_bias).conjugate() * window.q_bi_bj).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(windows.size())) * kToDegrees;
}

/// @param max_excluded_fraction limit on the fraction of windows without reliable ground truth
void expect_agreement(const std::filesystem::path& imu_csv, const std::filesystem::path& poses_txt,
                      double max_excluded_fraction) {
  ImuBuffer imu = read_imu_csv(imu_csv);
  const std::vector<StampedPose> truth = read_tum_poses(poses_txt);
  const std::vector<RotationWindow> windows = rotation_windows(imu, truth, kWindow);
  const Timestamp bias_end = after(truth.front().t, kBiasSpan);
  const auto rest = std::find_if(windows.begin(), windows.end(),
                                 [&](const RotationWindow& window) { return window.begin >= bias_end; });
  ASSERT_GE(rest - windows.begin(), 5);

  const Eigen::Vector3d bias = gyro_bias_of({windows.begin(), rest});
  const double rmse_deg = rotation_rmse_deg({rest, windows.end()}, bias);
  const double all = seconds_between(truth.front().t, truth.back().t) / kWindow;
  const double excluded_fraction = 1.0 - static_cast<double>(windows.size()) / all;
  std::cout << imu_csv.filename().string() << ": rotation over " << kWindow << " s, RMSE " << rmse_deg
            << " deg in " << windows.end() - rest << " windows (" << 100.0 * excluded_fraction
            << " % of the windows excluded), gyro bias " << bias.transpose() << " rad/s\n";
  ::testing::Test::RecordProperty("rotation_rmse_deg", std::to_string(rmse_deg));
  EXPECT_LE(rmse_deg, 0.3);
  EXPECT_LE(excluded_fraction, max_excluded_fraction);
}

TEST(RealRotation, AgreesWithMotionCaptureOnEurocV103) {
  const std::optional<std::filesystem::path> folder = find_test_data("imu/euroc");
  if (!folder) GTEST_SKIP() << missing_test_data("imu/euroc");
  expect_agreement(*folder / "V103_imu.csv", *folder / "V103_groundtruth.txt", 0.02);
}

TEST(RealRotation, AgreesWithMotionCaptureOnTumViRoom1) {
  const std::optional<std::filesystem::path> folder = find_test_data("imu/tum_vi");
  if (!folder) GTEST_SKIP() << missing_test_data("imu/tum_vi");
  expect_agreement(*folder / "room1_imu.csv", *folder / "room1_groundtruth.txt", 0.3);
}

TEST(RealRotation, TheUncorrectedGyroBiasIsSignificant) {
  const std::optional<std::filesystem::path> folder = find_test_data("imu/euroc");
  if (!folder) GTEST_SKIP() << missing_test_data("imu/euroc");
  ImuBuffer imu = read_imu_csv(*folder / "V103_imu.csv");
  const std::vector<StampedPose> truth = read_tum_poses(*folder / "V103_groundtruth.txt");
  const std::vector<RotationWindow> windows = rotation_windows(imu, truth, kWindow);
  // EuRoC's gyro bias is about 0.08 rad/s: 0.08 * 0.5 s = 2.3 degrees per window.
  EXPECT_GT(rotation_rmse_deg(windows, kZero), 2.0);
}

}  // namespace
}  // namespace stillpoint
