// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/motion/inertial_smoother.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/motion/camera_motion.h"
#include "datasets/synthetic/motion/path_spline.h"
#include "datasets/synthetic/sequence/recorded_motion.h"
#include "tests/support/test_data.h"

namespace stillpoint::synth {
namespace {

constexpr double kDegree = 0.017453292519943295;

TEST(BandedLeastSquares, SolvesAKnownSystem) {
  // x0 = 1, x1 - x0 = 2, x2 - x1 = 3 exactly: x = (1, 3, 6).
  BandedLeastSquares system(3, 2, 1);
  const std::vector<double> one{1.0}, difference{-1.0, 1.0};
  system.add(0, one, std::vector<double>{1.0}, 4.0);
  system.add(0, difference, std::vector<double>{2.0}, 1.0);
  system.add(1, difference, std::vector<double>{3.0}, 9.0);
  EXPECT_LT((system.solve() - Eigen::Vector3d(1.0, 3.0, 6.0)).norm(), 1e-12);
}

struct Recording {
  PathSpline truth;
  std::vector<StampedPose> poses;
  std::vector<ImuSample> imu;
};

/// A hand-held path measured by motion capture with 1 mm and 4 mrad of noise and a gap of 0.3 s, and by an
/// IMU with biases.
Recording jittery_recording(const Eigen::Vector3d& gyro_bias, const Eigen::Vector3d& accel_bias) {
  Recording recording{
      hand_path(HandMotion::kRpy, {{0.0, -2.0, 1.5}, {0.0, 0.0, 1.0}}, {Pose{}, 5, 0.0, 6.0}), {}, {}};
  RandomSequence random(1);
  const auto noise3 = [&random] {
    const double z = random.normal(), y = random.normal(), x = random.normal();
    return Eigen::Vector3d(x, y, z);
  };
  for (int i = 0; i <= 720; ++i) {
    const double t_s = i / 120.0;
    const bool gap = t_s > 3.0 && t_s < 3.3;
    const Pose pose = recording.truth.pose_at(t_s);
    const Eigen::Vector3d shake = noise3(), turn = noise3();
    if (gap) continue;
    recording.poses.push_back({from_seconds(t_s), {pose.q * exp_so3(0.004 * turn), pose.p + 0.001 * shake}});
  }
  for (int i = 0; i <= 1200; ++i) {
    const BodyMotion motion = recording.truth.at(i / 200.0);
    recording.imu.push_back({from_seconds(i / 200.0), motion.rate_b + gyro_bias + 0.002 * noise3(),
                             specific_force(motion) + accel_bias + 0.03 * noise3()});
  }
  return recording;
}

TEST(InertialSmoother, EstimatesPathAndBiasesMoreAccuratelyThanTheInputNoise) {
  const Eigen::Vector3d gyro_bias(0.02, -0.05, 0.08), accel_bias(0.1, -0.05, 0.08);
  const Recording recording = jittery_recording(gyro_bias, accel_bias);
  const SmoothedMotion motion = smooth_motion({recording.poses, recording.imu, Timestamp{0}, 0.0, 6.0});
  EXPECT_LT((motion.gyro_bias - gyro_bias).norm(), 0.002);
  EXPECT_LT((motion.accel_bias - accel_bias).norm(), 0.05);
  for (double t_s = 0.5; t_s < 5.5; t_s += 0.1) {  // includes the gap
    const Pose smooth = motion.path.pose_at(t_s), truth = recording.truth.pose_at(t_s);
    EXPECT_LT((smooth.p - truth.p).norm(), 0.001) << t_s;
    EXPECT_LT(log_so3(smooth.q.conjugate() * truth.q).norm(), 0.003) << t_s;
  }
}

/// RMS angle over windows of 0.5 s between the integrated gyroscope and the path [rad].
double rotation_disagreement(const RecordedMotion& motion) {
  const std::vector<datasets::VectorSample>& gyro = motion.readings.gyro;
  constexpr std::size_t kWindow = 100;  // samples at 200 Hz
  double squares = 0.0;
  int windows = 0;
  for (std::size_t i = 0; i + kWindow < gyro.size(); i += kWindow / 2, ++windows) {
    Eigen::Quaterniond integrated = Eigen::Quaterniond::Identity();
    for (std::size_t k = i; k < i + kWindow; ++k) {
      const Eigen::Vector3d rate = 0.5 * (gyro[k].value + gyro[k + 1].value) - motion.smoothed.gyro_bias;
      integrated = integrated * exp_so3(seconds_between(gyro[k].t, gyro[k + 1].t) * rate);
    }
    const Pose from = motion.smoothed.path.pose_at(seconds_between(motion.epoch, gyro[i].t));
    const Pose to = motion.smoothed.path.pose_at(seconds_between(motion.epoch, gyro[i + kWindow].t));
    squares += log_so3(integrated.conjugate() * from.q.conjugate() * to.q).squaredNorm();
  }
  return std::sqrt(squares / windows);
}

class RecordedMotionTest : public testing::TestWithParam<const char*> {};

TEST_P(RecordedMotionTest, SmoothedPathAgreesWithItsImuAndWithMotionCapture) {
  const std::string name = std::string("imu/") + GetParam();
  const auto path = find_test_data(name + "_groundtruth.txt"), imu = find_test_data(name + "_imu.csv");
  if (!path || !imu) GTEST_SKIP() << missing_test_data(name);
  SynthRequest request = preset_request("flight");
  request.trajectory_file = *path;
  request.imu_file = *imu;
  request.seconds = 20.0;
  const RecordedMotion motion = load_recorded_motion(request);
  EXPECT_LT(rotation_disagreement(motion), 0.1 * kDegree);
  EXPECT_LT(motion.smoothed.position_residual_m, 0.002);  // noise of motion capture, no drift
  EXPECT_LT(motion.smoothed.rotation_residual, 0.01);
  for (double t_s = 1.0; t_s < 20.0; t_s += 1.0) {  // the camera looks roughly horizontally
    const Eigen::Vector3d forward_w =
        (motion.smoothed.path.pose_at(t_s) * motion.T_b_c).q * Eigen::Vector3d::UnitZ();
    EXPECT_LT(std::abs(forward_w.z()), 0.85) << t_s;
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings, RecordedMotionTest,
                         testing::Values("euroc/V103", "tum_vi/room1", "tum_vi/room3"));

}  // namespace
}  // namespace stillpoint::synth
