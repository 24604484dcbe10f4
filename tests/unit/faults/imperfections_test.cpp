// SPDX-License-Identifier: BSD-3-Clause
// Imperfections: errors of the stated calibration, and what sensors add to their data for a whole sequence.
#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "core/base/error.h"
#include "core/geometry/so3.h"
#include "datasets/faults/faulty_stream.h"
#include "datasets/faults/image_faults.h"
#include "datasets/faults/inertial_faults.h"
#include "datasets/faults/rig_faults.h"

namespace stillpoint::datasets {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

Rig stated(const std::string& fault) {
  Rig rig;
  rig.camera = {.width = 640, .height = 480, .fx = 500.0, .fy = 400.0, .cx = 320.0, .cy = 240.0};
  rig.has_imu = true;
  rig.T_b_c.p = Eigen::Vector3d(0.1, 0.2, 0.3);
  return rig_with_fault(rig, parse_fault(fault));
}

/// 100 s at 200 Hz: constant rate and force.
std::vector<ImuSample> constant_samples() {
  std::vector<ImuSample> samples;
  for (int i = 0; i < 20000; ++i) {
    samples.push_back({.t = from_seconds(1.0 + 0.005 * i),
                       .gyro_b = Eigen::Vector3d(1.0, 2.0, 3.0),
                       .accel_b = Eigen::Vector3d(4.0, 5.0, 6.0)});
  }
  return samples;
}

std::vector<ImuSample> samples_with(const std::string& fault, const ImuNoise& noise = {}) {
  return samples_with_fault(constant_samples(), parse_fault(fault), from_seconds(1.1), noise);
}

/// 64x48 pixels: gray levels and depths that increase from left to right; 2 m in column 20.
Frame ramp() {
  Frame frame{.gray = cv::Mat(48, 64, CV_8UC1), .depth = cv::Mat(48, 64, CV_16UC1)};
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      frame.gray.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(60 + 2 * u);
      frame.depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(1000 + 50 * u);
    }
  }
  return frame;
}

Frame ramp_with(const std::string& fault, std::size_t index = 0) {
  return frame_with_fault(ramp(), parse_fault(fault), index);
}

TEST(StatedCalibration, DiffersByTheAmount) {
  EXPECT_DOUBLE_EQ(stated("focal_error:amount=2").camera.fx, 510.0);
  EXPECT_DOUBLE_EQ(stated("focal_error:amount=-2").camera.fy, 392.0);
  const Camera camera = stated("center_error:amount=5,seed=3").camera;
  EXPECT_NEAR(std::hypot(camera.cx - 320.0, camera.cy - 240.0), 5.0, 1e-12);
  EXPECT_DOUBLE_EQ(stated("distortion_error:amount=0.05").camera.distortion[0], -0.05);
  EXPECT_NEAR(log_so3(stated("rotation_error:amount=2").T_b_c.q).norm(), 2.0 * kRadiansPerDegree, 1e-12);
  EXPECT_NEAR((stated("lever_error:amount=0.02").T_b_c.p - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 0.02,
              1e-12);
}

TEST(StatedCalibration, DependsOnTheSeed) {
  EXPECT_EQ(stated("lever_error:seed=4").T_b_c.p, stated("lever_error:seed=4").T_b_c.p);
  EXPECT_NE(stated("lever_error:seed=4").T_b_c.p, stated("lever_error:seed=5").T_b_c.p);
}

TEST(ImperfectImu, ScalesEachAxisByTheAmount) {
  const ImuSample sample = samples_with("gyro_scale:amount=1").back();
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(std::abs(sample.gyro_b[axis] - (axis + 1.0)), 0.01 * (axis + 1.0), 1e-12);
  EXPECT_EQ(sample.accel_b, Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_NEAR((samples_with("accel_scale:amount=2").front().accel_b - Eigen::Vector3d(4.0, 5.0, 6.0)).norm(),
              0.02 * Eigen::Vector3d(4.0, 5.0, 6.0).norm(), 1e-12);
}

TEST(ImperfectImu, MisalignmentMixesAxes) {
  const double angle = 0.5 * kRadiansPerDegree;
  const ImuSample sample = samples_with("imu_misalignment:amount=0.5").back();
  EXPECT_NEAR(std::abs(sample.gyro_b.y() - 2.0), 3.0 * angle, 1e-12);
  EXPECT_NEAR(std::abs(sample.accel_b.y() - 5.0), 6.0 * angle, 1e-12);
  EXPECT_EQ(sample.gyro_b.z(), 3.0);
}

TEST(ImperfectImu, NoiseReachesTheRatioOfTheStatedDensity) {
  // Each axis has 20,000 samples: the deviation is known to 1 / sqrt(2 * 20000) = 0.5 %.
  const ImuNoise noise{.gyro_noise = 1e-3, .accel_noise = 1e-2};
  double gyro = 0.0, accel = 0.0;
  for (const ImuSample& sample : samples_with("imu_noise:amount=3", noise)) {
    gyro += (sample.gyro_b - Eigen::Vector3d(1.0, 2.0, 3.0)).squaredNorm() / (3 * 20000);
    accel += (sample.accel_b - Eigen::Vector3d(4.0, 5.0, 6.0)).squaredNorm() / (3 * 20000);
  }
  // Added to noise of the stated density d, the sum has 3 d: sqrt(9 - 1) d / sqrt(dt).
  const double per_sample = std::sqrt(8.0 / 0.005);
  EXPECT_NEAR(std::sqrt(gyro), 1e-3 * per_sample, 0.03 * 1e-3 * per_sample);
  EXPECT_NEAR(std::sqrt(accel), 1e-2 * per_sample, 0.03 * 1e-2 * per_sample);
}

TEST(ImperfectImu, VibrationHasTheAmplitude) {
  double largest = 0.0, sum = 0.0;
  for (const ImuSample& sample : samples_with("imu_vibration:amount=0.3")) {
    const double force = (sample.accel_b - Eigen::Vector3d(4.0, 5.0, 6.0)).norm();
    largest = std::max(largest, force);
    sum += force * force / 20000;
  }
  EXPECT_NEAR(largest, 0.3, 0.003);
  EXPECT_NEAR(std::sqrt(sum), 0.3 / std::sqrt(2.0), 0.01);
}

TEST(ImperfectImu, ClockOffsetAndDriftConcernAllSamples) {
  const std::vector<ImuSample> drifted = samples_with("clock_drift:amount=100");
  // 100 ppm, relative to the first frame at 1.1 s.
  EXPECT_NEAR(to_seconds(drifted.back().t), 100.995 + 1e-4 * 99.895, 1e-6);
  const std::vector<ImuSample> shifted = samples_with("time_offset:start=0,duration=1000000,amount=-0.02");
  EXPECT_NEAR(to_seconds(shifted.front().t), 0.98, 1e-9);
  EXPECT_NEAR(to_seconds(shifted.back().t), 100.975, 1e-9);
}

TEST(ImperfectImu, GSensitivityIsOfTheAmount) {
  // Forces along one axis of 9.80665 m/s^2 give a per sensor axis a / sqrt(3), in all a.
  const std::vector<ImuSample> samples =
      samples_with_fault({{.t = from_seconds(1.0),
                           .gyro_b = Eigen::Vector3d::Zero(),
                           .accel_b = 9.80665 * Eigen::Vector3d::UnitZ()}},
                         parse_fault("g_sensitivity:amount=0.1"), from_seconds(1.0), {});
  EXPECT_NEAR(samples.front().gyro_b.norm(), 0.1 * kRadiansPerDegree, 1e-12);
}

TEST(ImperfectDepth, HasBiasNoiseAndShift) {
  // 2 m with an error of 0.01 z^2: 2.04 m.
  EXPECT_EQ(ramp_with("depth_bias:amount=0.01").depth.at<std::uint16_t>(7, 20), 2040);
  double sum = 0.0, neighbors = 0.0;
  int count = 0;
  for (std::size_t index = 0; index < 40; ++index) {
    const Frame noisy = ramp_with("depth_noise:amount=0.05", index), clean = ramp();
    for (int v = 4; v < 48; v += 8) {
      const auto error = [&](int u) {
        const double z = clean.depth.at<std::uint16_t>(v, u) / 1000.0;
        return (noisy.depth.at<std::uint16_t>(v, u) / 1000.0 - z) / (0.05 * z * z);
      };
      for (int u = 1; u + 1 < 64; ++u, ++count) {
        sum += error(u) * error(u);
        neighbors += error(u) * error(u + 1);
      }
    }
  }
  EXPECT_NEAR(std::sqrt(sum / count), 1.0, 0.15);
  EXPECT_GT(neighbors / sum, 0.8);  // correlated
}

TEST(ImperfectDepth, IsDisplacedByTheDistance) {
  Frame frame = ramp();
  frame.depth.at<std::uint16_t>(24, 32) = 9000;
  double largest = 0.0;
  cv::Point at;
  cv::minMaxLoc(frame_with_fault(frame, parse_fault("depth_shift:amount=6"), 0).depth, nullptr, &largest,
                nullptr, &at);
  EXPECT_EQ(largest, 9000.0);
  EXPECT_NEAR(std::hypot(at.x - 32, at.y - 24), 6.0, 0.75);  // the nearest pixel
}

TEST(ImperfectImages, VignettingAndStepsFollowTheLight) {
  Frame flat{.gray = cv::Mat(49, 65, CV_8UC1, cv::Scalar(100))};
  const Frame vignetted = frame_with_fault(flat, parse_fault("vignetting:amount=0.36"), 0);
  EXPECT_EQ(vignetted.gray.at<std::uint8_t>(24, 32), 100);
  EXPECT_EQ(vignetted.gray.at<std::uint8_t>(0, 0), 80);  // sqrt(1 - 0.36) = 0.8
  std::set<int> levels;
  for (std::size_t index = 0; index < 60; ++index)
    levels.insert(
        frame_with_fault(flat, parse_fault("exposure_steps:amount=1"), index).gray.at<std::uint8_t>(0, 0));
  EXPECT_EQ(levels.size(), 3U);    // one level per 20 frames
  EXPECT_GE(*levels.begin(), 70);  // 100 / sqrt(2)
  EXPECT_LE(*levels.rbegin(), 142);
}

TEST(ImperfectImages, CompressionLosesMoreAtLowerQuality) {
  cv::Mat gray(45, 61, CV_8UC1);
  cv::RNG random(1);
  random.fill(gray, cv::RNG::UNIFORM, 0, 255);
  const Frame frame{.gray = gray};
  const auto loss = [&](const std::string& fault) {
    return cv::norm(frame_with_fault(frame, parse_fault(fault), 0).gray, gray, cv::NORM_L1) / (45.0 * 61.0);
  };
  EXPECT_LT(loss("jpeg:amount=100"), 0.6);  // steps of 1: rounding only
  EXPECT_GT(loss("jpeg:amount=80"), loss("jpeg:amount=95"));
  EXPECT_GT(loss("jpeg:amount=30"), loss("jpeg:amount=80"));
}

TEST(ImperfectImages, ExposureBlursAlongTheMotion) {
  Frame frame{.gray = cv::Mat::zeros(41, 41, CV_8UC1)};
  frame.gray.at<std::uint8_t>(20, 20) = 210;
  const Frame blurred = blurred_along(frame, Eigen::Vector2d(6.0, 0.0));
  EXPECT_EQ(cv::countNonZero(blurred.gray), 7);
  EXPECT_EQ(cv::countNonZero(blurred.gray.row(20)), 7);
  EXPECT_EQ(cv::countNonZero(blurred_along(frame, Eigen::Vector2d(0.4, 0.4)).gray), 1);
}

TEST(ConsumerRig, IsADrawOfSingleImperfections) {
  const std::vector<SensorFault> one = expanded_rigs({parse_fault("rig:seed=1"), parse_fault("blank")});
  EXPECT_EQ(one, expanded_rigs({parse_fault("rig:seed=1"), parse_fault("blank")}));
  EXPECT_NE(one, expanded_rigs({parse_fault("rig:seed=2"), parse_fault("blank")}));
  EXPECT_EQ(one.back(), parse_fault("blank"));
  std::set<FaultKind> kinds;
  for (const SensorFault& fault : one) {
    EXPECT_NE(fault.kind, FaultKind::kRig);
    EXPECT_EQ(parse_fault(fault_text(fault)), fault) << fault_text(fault);
    kinds.insert(fault.kind);
  }
  EXPECT_EQ(kinds.size(), one.size());
}

TEST(ConsumerRig, MagnitudesAreThoseOfTheDocument) {
  // 400 draws: a standard deviation is known to 1 / sqrt(800) = 3.5 %, the rate of short depth to 1.5 %.
  double focal = 0.0, offset = 0.0;
  int short_depths = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    for (const SensorFault& fault : expanded_rigs({{.kind = FaultKind::kRig, .amount = 1.0, .seed = seed}})) {
      if (fault.kind == FaultKind::kFocalError) focal += fault.amount * fault.amount / 400;
      if (fault.kind == FaultKind::kTimeOffset) offset += fault.amount * fault.amount / 400;
      if (fault.kind == FaultKind::kDepthScaled) short_depths += fault.amount < 0.9405 ? 1 : 0;
    }
  }
  EXPECT_NEAR(std::sqrt(focal), 1.0, 0.12);
  EXPECT_NEAR(std::sqrt(offset), 0.005, 0.0006);
  EXPECT_NEAR(short_depths, 0.1 * 0.8 * 400, 18);  // 1 - U(0.05, 0.1) is below 0.94 in four of five
}

TEST(ConsumerRig, WithoutMagnitudeChangesNothing) {
  for (const SensorFault& fault : expanded_rigs({parse_fault("rig:amount=0")})) {
    const FaultDescriptor& descriptor = descriptor_of(fault.kind);
    if (fault.kind == FaultKind::kDepthScaled || fault.kind == FaultKind::kImuNoise) {
      EXPECT_EQ(fault.amount, 1.0);
    } else {
      EXPECT_EQ(fault.amount, fault.kind == FaultKind::kJpeg ? 100.0 : 0.0) << descriptor.name;
    }
  }
}

}  // namespace
}  // namespace stillpoint::datasets
