// SPDX-License-Identifier: BSD-3-Clause
// Batch estimation of the calibration, on simulated recordings of rigs with known errors.
#include "core/calibration/calibrate.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

constexpr double kSeconds = 12.0;
constexpr double kRate_hz = 30.0;

/// Noisy recording of the rig of SimulatedMotion, whose depth is 8 % short and whose IMU is 6 ms late.
SimulatedMotion recorded_motion(std::uint32_t seed) {
  return {.pixel_noise_px = 0.3,
          .depth_noise = 0.003,
          .depth_factor = 0.92,
          .noisy_imu = true,
          .time_offset_s = 0.006,
          .points = 160,
          .track_length_s = 2.0,
          .seed = seed,
          .bias_walk = true};
}

/// The rig of the recording, with errors that a rig.toml may have.
Rig stated_rig(std::uint32_t seed) {
  Random random(4000 + seed);
  Rig rig = SimulatedMotion::rig();
  const double focal = 1.0 + 0.02 * random.normal();
  rig.camera.fx *= focal;
  rig.camera.fy *= focal;
  rig.camera.cx += 5.0 * random.normal();
  rig.camera.cy += 5.0 * random.normal();
  rig.camera.distortion[0] = 0.03 * random.normal();
  const Eigen::Vector3d rotation = 0.02 * random.normal3();
  rig.T_b_c.q = rig.T_b_c.q * exp_so3(rotation);
  const Eigen::Vector3d lever_m = 0.015 * random.normal3();
  rig.T_b_c.p += lever_m;
  return rig;
}

OdometryUpdate true_update(const SimulatedMotion& motion, double t) {
  OdometryUpdate update;
  update.state = SimulatedMotion::state(motion.path_time(t + motion.time_offset_s));
  update.T_w_c = update.state.T_w_b * SimulatedMotion::rig().T_b_c;
  update.status = OdometryStatus::kTracking;
  return update;
}

CalibrationInput recording(const SimulatedMotion& motion, const Rig& stated, bool inertial = true,
                           double interval_s = 0.2) {
  CalibrationCollector collector(interval_s);
  const std::vector<DynamicLabel> labels(1, DynamicLabel{.id = -1});
  for (int i = 0; i < static_cast<int>(kSeconds * kRate_hz); ++i) {
    const double t = 0.1 + i / kRate_hz;
    collector.add(motion.frame(i, t), labels, true_update(motion, t));
  }
  CalibrationInput input{.stated = {.rig = stated, .depth_camera = stated.camera},
                         .sections = collector.finish()};
  if (inertial) input.imu = motion.imu(kSeconds + 1.0);
  return input;
}

const ParameterEstimate& parameter(const CalibrationResult& result, const std::string& name) {
  const auto found = std::ranges::find(result.parameters, name, &ParameterEstimate::name);
  EXPECT_NE(found, result.parameters.end()) << name;
  return *found;
}

/// The true value of a parameter, in its unit.
double true_value(const ParameterEstimate& estimate, const Rig& stated) {
  const Rig rig = SimulatedMotion::rig();
  const Eigen::Vector3d rotation_deg =
      180.0 / std::numbers::pi * log_so3(stated.T_b_c.q.conjugate() * rig.T_b_c.q);
  const std::map<std::string, double> values = {{"fx", rig.camera.fx},
                                                {"fy", rig.camera.fy},
                                                {"cx", rig.camera.cx},
                                                {"cy", rig.camera.cy},
                                                {"depth scale", 0.92},
                                                {"time_offset_s", 6.0},
                                                {"T_b_c x", 1e3 * rig.T_b_c.p.x()},
                                                {"T_b_c y", 1e3 * rig.T_b_c.p.y()},
                                                {"T_b_c z", 1e3 * rig.T_b_c.p.z()},
                                                {"T_b_c rotation x", rotation_deg.x()},
                                                {"T_b_c rotation y", rotation_deg.y()},
                                                {"T_b_c rotation z", rotation_deg.z()}};
  const auto found = values.find(estimate.name);
  return found == values.end() ? 0.0 : found->second;  // distortion and rolling shutter
}

/// Squared errors of observed values in claimed deviations.
struct NormalizedErrors {
  double squares = 0.0;
  int count = 0, outside = 0;

  void add(const CalibrationResult& result, const Rig& stated, std::uint32_t seed) {
    for (const ParameterEstimate& estimate : result.parameters) {
      if (estimate.outcome == ParameterOutcome::kNotObserved) continue;
      const double error = (estimate.value - true_value(estimate, stated)) / estimate.sigma;
      squares += error * error;
      ++count;
      if (std::abs(error) <= 3.0) continue;
      ++outside;
      std::printf("seed %u, %s: %.2f sigma\n", seed, estimate.name.c_str(), error);
    }
  }
  void print() const {
    std::printf("%d estimates, %d beyond 3 sigma, mean normalized squared error %.3f\n", count, outside,
                squares / count);
  }
};

/// Lets each track drift off its point by a random walk.
void add_drift(CalibrationInput& input, double px_per_keyframe, std::uint32_t seed) {
  Random random(seed);
  std::map<std::int64_t, Eigen::Vector2d> drifts;
  for (CalibrationKeyframe& keyframe : input.sections.front().keyframes) {
    for (CalibrationFeature& feature : keyframe.features) {
      const auto [drift, is_new] = drifts.try_emplace(feature.track, Eigen::Vector2d::Zero());
      if (!is_new) drift->second += px_per_keyframe * random.normal2();
      feature.pixel += drift->second;
    }
  }
}

TEST(Calibrate, FindsRigsWithinTheirClaimedDeviations) {
  NormalizedErrors errors;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const Rig stated = stated_rig(seed);
    const CalibrationResult result = calibrate(recording(recorded_motion(seed), stated), {.hold_out = false});
    ASSERT_TRUE(result.usable);
    errors.add(result, stated, seed);
  }
  errors.print();
  EXPECT_GE(errors.count, 20 * 12);  // all but the lever arm, which this motion does not show
  EXPECT_LE(errors.outside, 0.03 * errors.count);
  EXPECT_GT(errors.squares / errors.count, 0.7);
  EXPECT_LT(errors.squares / errors.count, 1.4);
}

TEST(Calibrate, ClaimsLargerDeviationsForTracksThatDrift) {
  NormalizedErrors errors;
  for (std::uint32_t seed = 0; seed < 2; ++seed) {
    const Rig stated = stated_rig(seed);
    SimulatedMotion motion = recorded_motion(seed);
    motion.track_length_s = 4.0;
    CalibrationInput input = recording(motion, stated, true, 0.1);
    add_drift(input, 0.3, seed);
    errors.add(calibrate(input, {.hold_out = false}), stated, seed);
  }
  errors.print();
  EXPECT_GE(errors.count, 2 * 11);
  // As if all residuals were independent: 5 beyond 3 sigma. The errors of a rig are correlated.
  EXPECT_EQ(errors.outside, 0);
  EXPECT_LT(errors.squares / errors.count, 2.0);
}

const Pose kTruthBody{exp_so3({0.3, -0.2, 1.1}), {0.05, -0.1, 0.2}};  // T_f_b
constexpr double kTruthDelay_s = 0.04;

/// Ground truth at 100 Hz in another world, of another frame, late, up to a time, with initial values that
/// are off.
CalibrationTruth recorded_truth(const SimulatedMotion& motion, double end_s) {
  const Pose T_g_w{exp_so3({0.1, 0.4, -2.0}), {3.0, -1.0, 0.5}};
  CalibrationTruth truth{.T_f_b = Pose{kTruthBody.q * exp_so3({0.05, 0.05, -0.05}), Eigen::Vector3d::Zero()},
                         .delay_s = kTruthDelay_s + 0.02};
  for (int i = 0; i < static_cast<int>(100.0 * end_s); ++i) {
    const double t = 0.01 * i;
    const Pose T_w_b = SimulatedMotion::state(motion.path_time(t + motion.time_offset_s)).T_w_b;
    truth.trajectory.poses.emplace_back(after(motion.frame(0, 0.0).t, t + kTruthDelay_s),
                                        T_g_w * T_w_b * kTruthBody.inverse());
  }
  return truth;
}

TEST(Calibrate, FindsDelayAndFrameOfAGroundTruth) {
  const Rig stated = stated_rig(7);
  const SimulatedMotion motion = recorded_motion(7);
  CalibrationInput input = recording(motion, stated);
  const CalibrationResult without = calibrate(input, {.hold_out = false});
  for (const double end_s : {kSeconds, 0.5 * kSeconds}) {
    input.truth = recorded_truth(motion, end_s);
    const CalibrationResult result = calibrate(input, {.hold_out = false});
    ASSERT_TRUE(result.usable);
    EXPECT_EQ(result.truth_poses < result.keyframes, end_s < kSeconds);
    const Eigen::Vector3d rotation_deg = 180.0 / std::numbers::pi * log_so3(kTruthBody.q);
    const auto expect_near = [&](const std::string& name, double expected, double most) {
      const ParameterEstimate& estimate = parameter(result, name);
      EXPECT_NEAR(estimate.value, expected, std::min(3.0 * estimate.sigma, most)) << name;
    };
    expect_near("truth delay", 1e3 * kTruthDelay_s, 1.0);
    const char* const axes[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      expect_near(std::string("truth T_f_b ") + axes[axis], 1e3 * kTruthBody.p[axis], 20.0);
      expect_near(std::string("truth T_f_b rotation ") + axes[axis], rotation_deg[axis], 0.5);
    }
    for (const char* name : {"fx", "cx", "depth scale", "T_b_c rotation x", "time_offset_s"}) {
      const ParameterEstimate& estimate = parameter(result, name);
      EXPECT_LT(std::abs(estimate.value - true_value(estimate, stated)), 3.0 * estimate.sigma) << name;
      EXPECT_LE(estimate.sigma, 1.05 * parameter(without, name).sigma) << name;
    }
  }
  input.truth = recorded_truth(motion, 1.0);
  expect_input_error([&] { static_cast<void>(calibrate(input, {})); }, {"ground truth", "keyframes"});
}

// The noise of the gyroscope has a derivative, too, which is no motion.
TEST(Calibrate, ACameraAtRestShowsNeitherTimeOffsetNorReadoutTime) {
  SimulatedMotion motion = recorded_motion(5);
  motion.stop_s = 1e-9;  // and at rest 1 s later
  CalibrationInput input = recording(motion, stated_rig(5));
  const Timestamp rest = from_seconds(1.2);
  std::erase_if(input.imu, [&](const ImuSample& sample) { return sample.t < rest; });
  std::erase_if(input.sections.front().keyframes,
                [&](const CalibrationKeyframe& keyframe) { return keyframe.state.t < rest; });
  const CalibrationResult result = calibrate(input, {.hold_out = false});
  EXPECT_EQ(parameter(result, "time_offset_s").outcome, ParameterOutcome::kNotObserved);
  EXPECT_EQ(result.calibration.rig.time_offset_s, 0.0);
  EXPECT_EQ(parameter(result, "rolling_shutter_s").outcome, ParameterOutcome::kNotObserved);
}

TEST(Calibrate, WithoutAnImuTheDepthScaleStaysAsStated) {
  const CalibrationResult result =
      calibrate(recording(recorded_motion(1), stated_rig(1), false), {.hold_out = false});
  EXPECT_EQ(parameter(result, "depth scale").outcome, ParameterOutcome::kNotObserved);
  EXPECT_EQ(result.calibration.rig.depth_units_per_m, 1000.0);
  EXPECT_EQ(parameter(result, "fx").outcome, ParameterOutcome::kDiffers);
  EXPECT_NEAR(result.calibration.rig.camera.fx, 500.0, 3.0 * parameter(result, "fx").sigma);
}

TEST(Calibrate, ValuesThatAreNotToBeEstimatedStayAsStated) {
  const Rig stated = stated_rig(2);
  const CalibrationResult result =
      calibrate(recording(recorded_motion(2), stated),
                {.estimate = {.focal = false, .extrinsics = false}, .hold_out = false});
  EXPECT_EQ(result.calibration.rig.camera.fx, stated.camera.fx);
  EXPECT_EQ(result.calibration.rig.T_b_c.p, stated.T_b_c.p);
  EXPECT_TRUE(std::ranges::none_of(result.parameters, [](const auto& p) { return p.name == "fx"; }));
}

TEST(Calibrate, HeldOutResidualsDecreaseToTheNoise) {
  Rig stated = SimulatedMotion::rig();
  stated.camera.distortion[0] = 0.1;
  const CalibrationResult result = calibrate(recording(recorded_motion(3), stated), {});
  ASSERT_TRUE(result.has_held_out);
  EXPECT_GT(result.held_out.pixel_before_px, 1.2 * result.held_out.pixel_after_px);
  EXPECT_NEAR(result.held_out.pixel_after_px, 0.3, 0.04);
  EXPECT_NEAR(result.pixel_sigma_px, 0.3, 0.03);
  EXPECT_NEAR(result.inverse_depth_sigma, 0.003 / 0.92, 0.0003);  // of the depth as it is measured
  EXPECT_LT(result.deviation_factor, 2.0);
}

TEST(Calibrate, KeepsTheLastIterationWhenStopped) {
  const CalibrationResult result = calibrate(
      recording(recorded_motion(4), stated_rig(4)),
      {.on_iteration = [](const CalibrationProgress& now) { return now.step == 0 && now.iteration < 5; }});
  EXPECT_TRUE(result.interrupted);
  EXPECT_FALSE(result.has_held_out);
  EXPECT_NEAR(result.calibration.rig.camera.fx, 500.0, 5.0);
}

TEST(Calibrate, RejectsRecordingsWithoutScaleOrMotion) {
  CalibrationInput input = recording(recorded_motion(5), stated_rig(5), false);
  for (CalibrationKeyframe& keyframe : input.sections.front().keyframes) {
    for (CalibrationFeature& feature : keyframe.features) feature.depth_m = 0.0;
  }
  expect_input_error([&] { static_cast<void>(calibrate(input, {})); }, {"metric scale"});
  input.sections.front().keyframes.resize(5);
  expect_input_error([&] { static_cast<void>(calibrate(input, {})); }, {"5 keyframes"});
}

TEST(CalibrationCollector, LeavesOutTracksThatWereDynamicAtAnyTime) {
  CalibrationCollector collector(0.1);
  const SimulatedMotion motion = recorded_motion(6);
  for (int i = 0; i < 10; ++i) {
    const TrackedFrame frame = motion.frame(i, 0.1 * i);
    const std::vector<DynamicLabel> labels = {
        {.id = frame.features.front().id,
         .label = i == 9 ? LabelClass::kDynamicMotion : LabelClass::kStable}};
    collector.add(frame, labels, true_update(motion, 0.1 * i));
  }
  const std::int64_t dynamic = motion.frame(9, 0.9).features.front().id;
  const std::vector<CalibrationSection> sections = collector.finish();
  ASSERT_EQ(sections.size(), 1u);
  ASSERT_EQ(sections.front().keyframes.size(), 10u);
  for (const CalibrationKeyframe& keyframe : sections.front().keyframes)
    EXPECT_TRUE(std::ranges::none_of(keyframe.features, [&](const auto& f) { return f.track == dynamic; }));
}

TEST(Calibrate, RecordingsOfOneDeviceShareTheCalibrationOnly) {
  const Rig stated = stated_rig(3);
  CalibrationInput all = recording(recorded_motion(3), stated);
  const CalibrationResult one = calibrate(all, {.hold_out = false});
  append_recording(all, recording(recorded_motion(4), stated));  // at the same times
  append_recording(all, recording(recorded_motion(5), stated));
  const CalibrationResult result = calibrate(all, {.hold_out = false});
  ASSERT_TRUE(result.usable);
  EXPECT_EQ(result.keyframes, 3 * one.keyframes);
  EXPECT_EQ(result.inertial_factors, 3 * one.inertial_factors);
  for (const char* name : {"fx", "cx", "depth scale", "time_offset_s", "T_b_c rotation x"}) {
    const ParameterEstimate& estimate = parameter(result, name);
    EXPECT_LT(std::abs(estimate.value - true_value(estimate, stated)), 3.0 * estimate.sigma) << name;
    EXPECT_LE(estimate.sigma, parameter(one, name).sigma) << name;
  }
}

TEST(Calibrate, RecordingsOfDifferentDevicesAreRefused) {
  const auto append = [](const CalibrationInput& next) {
    CalibrationInput all = recording(recorded_motion(3), stated_rig(3));
    append_recording(all, next);
  };
  expect_input_error([&] { append(recording(recorded_motion(4), stated_rig(4))); },
                     {"one device", "[camera] fx is "});
  expect_input_error([&] { append(recording(recorded_motion(4), stated_rig(3), false)); }, {"inertial data"});
}

}  // namespace
}  // namespace stillpoint
