// SPDX-License-Identifier: BSD-3-Clause
// Reactions of the estimator to failures of vision and of inertial data, on simulated motion. Undisturbed,
// the largest error is 0.008 m with and 0.007 m without an IMU.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/support/published_config.h"
#include "tests/support/simulated/faulty_run.h"

namespace stillpoint {
namespace {

using enum OdometryStatus;

/// No depth before `end`.
std::function<void(TrackedFrame&)> no_depth(double end) {
  return [=](TrackedFrame& frame) {
    if (to_seconds(frame.t) >= end) return;
    for (TrackedFeature& feature : frame.features) feature.depth = 0.0;
  };
}

FaultyScenario visual_scenario() {
  FaultyScenario scenario;
  scenario.uses_imu = false;
  return scenario;
}

TEST(EstimatorFaults, TheStatusOfAnUndisturbedRunIsTracking) {
  for (const bool uses_imu : {true, false}) {
    FaultyScenario scenario;
    scenario.uses_imu = uses_imu;
    const FaultyRun run = run_with_faults(scenario);
    EXPECT_EQ(run.count(0.5, kEnd_s, kTracking),
              run.count(0.5, kEnd_s, [](const FaultyFrame&) { return true; }));
    EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.015);
  }
}

TEST(EstimatorFaults, AStartNeedsAWindowThatVisionLocated) {
  FaultyScenario scenario;
  scenario.change_frame = no_depth(0.45);
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_EQ(run.count_located(0.0, 0.45), 0);
  EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.02);  // was 0.148
  scenario.backend = published_config().backend;
  scenario.backend.rate_hz = 0.0;
  EXPECT_LT(run_with_faults(scenario).worst_error_m(0.0, kEnd_s), 0.03);
}

TEST(EstimatorFaults, WithoutAnyDepthThereIsNoStart) {
  FaultyScenario scenario;
  scenario.change_frame = no_depth(kEnd_s);
  for (const bool uses_imu : {true, false}) {
    scenario.uses_imu = uses_imu;
    EXPECT_EQ(run_with_faults(scenario).count_located(0.0, kEnd_s), 0);
  }
}

TEST(EstimatorFaults, AccelerationsThatVisionContradictsAreIgnored) {
  for (const Eigen::Vector3d& force : {Eigen::Vector3d(8.0, 0.0, 0.0), Eigen::Vector3d(0.0, 15.0, 12.0)}) {
    FaultyScenario scenario;
    scenario.change_imu = shock(kBegin_s, kBegin_s + 1.0, force);
    const FaultyRun run = run_with_faults(scenario);
    EXPECT_EQ(run.count_located(0.5, kEnd_s), run.count(0.5, kEnd_s, is_finite));
    EXPECT_GT(run.count(4.2, 5.0, kDegraded), 20);
    EXPECT_EQ(run.count(6.0, kEnd_s, kTracking), run.count(6.0, kEnd_s, is_finite));
    EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.03);
    const Eigen::Vector3d bias = run.frames.back().update.state.accel_bias;
    EXPECT_LT((bias - Eigen::Vector3d::Constant(0.05)).norm(), 0.2);
  }
}

TEST(EstimatorFaults, AGyroscopeThatVisionContradictsIsIgnored) {
  FaultyScenario scenario;
  scenario.change_imu = [](std::vector<ImuSample>& samples) {
    for (ImuSample& sample : samples) {
      if (to_seconds(sample.t) > kBegin_s) sample.gyro_b.array() += 0.3;
    }
  };
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_EQ(run.count_located(0.5, kEnd_s), run.count(0.5, kEnd_s, is_finite));
  EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.03);
}

TEST(EstimatorFaults, ADivergedEstimateIsLostAndItsBiasesAreForgotten) {
  FaultyScenario scenario;
  scenario.change_imu = [](std::vector<ImuSample>& samples) {
    for (ImuSample& sample : samples) {
      if (to_seconds(sample.t) > 4.0 && to_seconds(sample.t) < 4.02) sample.accel_b.x() = 1e300;
    }
  };
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_EQ(run.count(0.0, kEnd_s, is_finite), static_cast<int>(run.frames.size()));
  EXPECT_EQ(run.count(6.0, kEnd_s, kTracking), run.count(6.0, kEnd_s, is_finite));
  EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.05);
  const Eigen::Vector3d bias = run.frames.back().update.state.accel_bias;
  EXPECT_LT((bias - Eigen::Vector3d::Constant(0.05)).norm(), 0.2);
}

TEST(EstimatorFaults, FeaturesThatAreNotFiniteEndInADefinedState) {
  for (const bool uses_imu : {true, false}) {
    FaultyScenario scenario;
    scenario.uses_imu = uses_imu;
    scenario.change_frame = [](TrackedFrame& frame) {
      const double t = to_seconds(frame.t);
      if (t < 4.0 || t >= 4.3) return;
      for (TrackedFeature& feature : frame.features) {
        feature.bearing.x() = std::numeric_limits<double>::quiet_NaN();
      }
    };
    const FaultyRun run = run_with_faults(scenario);
    EXPECT_EQ(run.count(0.0, kEnd_s, is_finite), static_cast<int>(run.frames.size()));
    EXPECT_EQ(run.count_located(4.0, 4.3), 0);
    EXPECT_EQ(run.count(6.0, kEnd_s, kTracking), run.count(6.0, kEnd_s, is_finite));
    EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.05);
  }
}

struct BlankCase {
  double seconds;
  double max_error_m;  ///< at the return of the view
};

TEST(EstimatorFaults, BlankImagesLeadToDeadReckoning) {
  for (const BlankCase& blanked : {BlankCase{0.2, 0.02}, BlankCase{1.0, 0.05}, BlankCase{5.0, 0.5}}) {
    FaultyScenario scenario;
    const double end = kBegin_s + blanked.seconds;
    scenario.change_frame = blank(kBegin_s, end, false);
    const FaultyRun run = run_with_faults(scenario);
    EXPECT_EQ(run.count_located(kBegin_s + 0.01, end - 0.01), 0);
    EXPECT_GE(run.count(kBegin_s, end, kDeadReckoning), static_cast<int>(30.0 * blanked.seconds) - 2);
    EXPECT_EQ(run.count_located(end + 0.05, kEnd_s), run.count(end + 0.05, kEnd_s, is_finite));
    EXPECT_LT(run.worst_error_m(0.0, kEnd_s), blanked.max_error_m);
    EXPECT_EQ(run.frames.back().update.segment, 0);
  }
}

TEST(EstimatorFaults, RecognizedLandmarksEndTheDriftOfDeadReckoning) {
  FaultyScenario scenario;
  scenario.change_frame = blank(kBegin_s, kBegin_s + 5.0, true);
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_EQ(run.count(8.9, 9.1, kRelocated), 1);
  EXPECT_LT(run.worst_error_m(9.0, kEnd_s), 0.02);
}

TEST(EstimatorFaults, DeadReckoningForTooLongIsALoss) {
  FaultyScenario scenario;
  scenario.backend.max_dead_reckoning_s = 0.5;
  scenario.change_frame = blank(kBegin_s, kBegin_s + 1.0, true);
  const FaultyRun recognized = run_with_faults(scenario);
  EXPECT_GE(recognized.count(4.6, 5.0, kLost), 11);
  EXPECT_EQ(recognized.count(4.9, 5.1, kRelocated), 1);
  EXPECT_LT(recognized.worst_error_m(0.0, kEnd_s), 0.02);
  scenario.change_frame = blank(kBegin_s, kBegin_s + 1.0, false);
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_EQ(run.count_located(4.6, 6.0), 0);
  EXPECT_EQ(run.frames.back().update.segment, 1);
  EXPECT_EQ(run.count(7.0, kEnd_s, kTracking), run.count(7.0, kEnd_s, is_finite));
}

TEST(EstimatorFaults, VisualOdometryIsLostInBlankImagesAndRelocatedAfterThem) {
  for (const double seconds : {0.2, 1.0}) {
    FaultyScenario scenario = visual_scenario();
    const double end = kBegin_s + seconds;
    scenario.change_frame = blank(kBegin_s, end, true);
    const FaultyRun run = run_with_faults(scenario);
    EXPECT_EQ(run.count_located(kBegin_s + 0.01, end - 0.01), 0);
    EXPECT_EQ(run.count(end - 0.01, end + 0.05, kRelocated), 1);
    EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.02);  // was 0.09 and 0.50
    EXPECT_EQ(run.frames.back().update.segment, 0);
  }
}

TEST(EstimatorFaults, VisualOdometryBeginsANewSegmentInAnUnknownView) {
  FaultyScenario scenario = visual_scenario();
  scenario.change_frame = blank(kBegin_s, kBegin_s + 1.0, false);
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_EQ(run.count_located(kBegin_s + 0.01, 6.0), 0);
  EXPECT_EQ(run.frames.back().update.segment, 1);
  EXPECT_EQ(run.count(6.2, kEnd_s, kTracking), run.count(6.2, kEnd_s, is_finite));
}

/// Before the inertial start there is nothing that data after a gap could be compared with.
TEST(EstimatorFaults, AGapBeforeTheInertialStartDelaysItOnly) {
  FaultyScenario scenario;
  scenario.change_imu = imu_gap(0.1, 0.2);
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_GT(run.count(1.0, kBegin_s, kTracking), 80);
}

TEST(EstimatorFaults, VisionBridgesAGapOfTheImu) {
  for (const double seconds : {0.1, 1.0, 3.0}) {
    FaultyScenario scenario;
    scenario.change_imu = imu_gap(kBegin_s, kBegin_s + seconds);
    const FaultyRun run = run_with_faults(scenario);
    EXPECT_EQ(run.count_located(0.5, kEnd_s), run.count(0.5, kEnd_s, is_finite));
    EXPECT_GT(run.count(kBegin_s, kBegin_s + seconds + 0.1, kDegraded), 0);
    EXPECT_EQ(run.count(8.0, kEnd_s, kTracking), run.count(8.0, kEnd_s, is_finite));
    EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.02);
  }
}

TEST(EstimatorFaults, AStraightLineAcrossAGapOfAShakingImuIsNotBelieved) {
  FaultyScenario scenario;
  scenario.change_imu = [](std::vector<ImuSample>& samples) {
    // The last sample before each gap and the first one after it are those of a shaken sensor.
    for (ImuSample& sample : samples) {
      const double phase = std::fmod(to_seconds(sample.t), 0.5);
      if (to_seconds(sample.t) > kBegin_s && (phase < 0.006 || (phase > 0.079 && phase < 0.086))) {
        sample.accel_b.x() += 20.0;
      }
    }
    std::erase_if(samples, [](const ImuSample& sample) {
      const double phase = std::fmod(to_seconds(sample.t), 0.5);
      return to_seconds(sample.t) > kBegin_s && phase > 0.006 && phase < 0.079;
    });
  };
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_EQ(run.count_located(0.5, kEnd_s), run.count(0.5, kEnd_s, is_finite));
  EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.03);
}

TEST(EstimatorFaults, StepsOfTheBiasesAreFollowed) {
  for (const bool of_gyro : {true, false}) {
    FaultyScenario scenario;
    scenario.change_imu = [&](std::vector<ImuSample>& samples) {
      for (ImuSample& sample : samples) {
        if (to_seconds(sample.t) < kBegin_s) continue;
        (of_gyro ? sample.gyro_b : sample.accel_b).array() += of_gyro ? 0.02 : 0.5;
      }
    };
    EXPECT_GT(run_with_faults(scenario).worst_error_m(0.0, kEnd_s), of_gyro ? 0.015 : 0.05);
    scenario.backend.bias_steps = true;
    const FaultyRun run = run_with_faults(scenario);
    EXPECT_LT(run.worst_error_m(0.0, kEnd_s), of_gyro ? 0.015 : 0.03);
    const NavState& last = run.frames.back().update.state;
    EXPECT_LT((last.gyro_bias - Eigen::Vector3d::Constant(of_gyro ? 0.04 : 0.02)).norm(), 0.005);
    EXPECT_LT((last.accel_bias - Eigen::Vector3d::Constant(of_gyro ? 0.05 : 0.55)).norm(), 0.1);
  }
}

FaultyRun run_default(const FaultyScenario& scenario) {
  Estimator estimator(BackendConfig{}, ImuConfig{}, rig_of(scenario), 1);
  return run_with_faults(scenario, estimator,
                         [&](const TrackedFrame& frame) { return estimator.process(frame); });
}

NavState last_of_default(const FaultyScenario& scenario) {
  return run_default(scenario).frames.back().update.state;
}

/// Too small to be recognized as a step, as when an accelerometer becomes warm. With the stated random walk
/// the bias error grows in all of ten runs.
TEST(EstimatorFaults, SmallChangesOfTheAccelerometerBiasAreFollowedByTheDefault) {
  const Eigen::Vector3d change = Eigen::Vector3d::Constant(0.05);
  int followed = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    FaultyScenario scenario;
    scenario.motion.seed = seed;
    scenario.change_imu = [&](std::vector<ImuSample>& samples) {
      for (ImuSample& sample : samples) {
        if (to_seconds(sample.t) >= kBegin_s) sample.accel_b += change;
      }
    };
    const Eigen::Vector3d bias = last_of_default(scenario).accel_bias;
    followed += (bias - scenario.motion.accel_bias - change).norm() < change.norm();
  }
  EXPECT_GE(followed, 8);
}

/// Thirty features: vision is not certain, as where people hide most of the scene.
TEST(EstimatorFaults, StepsOfTheGyroscopeAreFollowedByFewFeatures) {
  const Eigen::Vector3d change = Eigen::Vector3d::Constant(0.02);
  int followed = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    FaultyScenario scenario;
    scenario.motion.seed = seed;
    scenario.change_frame = [](TrackedFrame& frame) {
      if (frame.features.size() > 30) frame.features.resize(30);
    };
    scenario.change_imu = [&](std::vector<ImuSample>& samples) {
      for (ImuSample& sample : samples) {
        if (to_seconds(sample.t) >= kBegin_s) sample.gyro_b += change;
      }
    };
    followed += (last_of_default(scenario).gyro_bias - scenario.motion.gyro_bias - change).norm() < 0.005;
  }
  EXPECT_GE(followed, 9);
}

/// Rows that are displaced from one frame on, by 0.01 to 0.03 focal lengths, as by another readout: vision
/// turns at once, which looks like a step in the two next measurements. In all of ten runs the bias followed
/// it, by 0.03 rad/s.
TEST(EstimatorFaults, ImagesThatAreDisplacedAtOnceAreNoStepOfTheGyroscope) {
  int kept = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    FaultyScenario scenario;
    scenario.motion.seed = seed;
    scenario.change_frame = [](TrackedFrame& frame) {
      if (to_seconds(frame.t) < kBegin_s) return;
      for (TrackedFeature& feature : frame.features)
        feature.bearing.x() += 0.02 * (feature.bearing.y() + 1.0);
    };
    double largest = 0.0;
    for (const auto& frame : run_default(scenario).frames) {
      if (frame.t >= kBegin_s)
        largest = std::max(largest, (frame.update.state.gyro_bias - scenario.motion.gyro_bias).norm());
    }
    kept += largest < 0.01;
  }
  EXPECT_GE(kept, 9);
}

/// Two pixels of noise are more than the check of the biases expects: an error of vision, not of the sensor.
TEST(EstimatorFaults, NoisyFeaturesAreNoStepOfTheBiases) {
  FaultyScenario scenario;
  scenario.motion.pixel_noise_px = 2.0;
  const FaultyRun without = run_with_faults(scenario);
  scenario.backend.bias_steps = true;
  const FaultyRun with = run_with_faults(scenario);
  for (std::size_t i = 0; i < with.frames.size(); ++i) {
    ASSERT_EQ(with.frames[i].update.state.T_w_b.p, without.frames[i].update.state.T_w_b.p)
        << with.frames[i].t;
  }
}

TEST(EstimatorFaults, SamplesWithAWrongTimeAreNotUsed) {
  FaultyScenario scenario;
  scenario.change_imu = [](std::vector<ImuSample>& samples) {
    for (ImuSample& sample : samples) {
      if (to_seconds(sample.t) >= kBegin_s) sample.t = after(sample.t, 0.1);
    }
  };
  const double error_m = run_with_faults(scenario).worst_error_m(0.0, kEnd_s);
  scenario.backend.bias_steps = true;
  const FaultyRun checked = run_with_faults(scenario);
  EXPECT_GE(checked.count(kBegin_s, kBegin_s + 0.6, kDegraded),
            3);  // before it is known which sensor is wrong
  const double checked_m = checked.worst_error_m(0.0, kEnd_s);
  EXPECT_LT(checked_m, 0.05);
  EXPECT_LT(checked_m, error_m);
}

TEST(EstimatorFaults, DepthWhoseScaleChangesIsNotUsed) {
  for (const auto& [uses_imu, scale] :
       {std::pair(true, 0.85), std::pair(false, 0.85), std::pair(true, 0.955)}) {
    FaultyScenario scenario;
    scenario.uses_imu = uses_imu;
    scenario.change_frame = [scale = scale](TrackedFrame& frame) {
      if (to_seconds(frame.t) < kBegin_s || to_seconds(frame.t) >= 8.0) return;
      for (TrackedFeature& feature : frame.features) feature.depth *= scale;
    };
    if (scale < 0.9) {
      EXPECT_GT(run_with_faults(scenario).worst_error_m(0.0, kEnd_s), 0.03);
    }
    scenario.backend.depth.max_scale_error = 0.04;
    EXPECT_LT(run_with_faults(scenario).worst_error_m(0.0, kEnd_s), 0.02);
  }
}

TEST(EstimatorFaults, AWrongTimeOffsetLosesNoPose) {
  FaultyScenario scenario;
  scenario.motion.time_offset_s = 0.1;
  const FaultyRun run = run_with_faults(scenario);
  EXPECT_EQ(run.count_located(0.5, kEnd_s), run.count(0.5, kEnd_s, is_finite));
}

TEST(EstimatorFaults, AnImuAsSlowAsTheCameraIsAccurate) {
  FaultyScenario scenario;
  scenario.imu_rate_hz = 30.0;
  EXPECT_LT(run_with_faults(scenario).worst_error_m(0.0, kEnd_s), 0.02);  // was 0.19
}

}  // namespace
}  // namespace stillpoint
