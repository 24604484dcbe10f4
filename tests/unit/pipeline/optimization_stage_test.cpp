// SPDX-License-Identifier: BSD-3-Clause
// Verdicts on a simulated flight in which some points walk, and what they do to the estimate.
#include "core/pipeline/optimization_stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/support/simulated_flight.h"

namespace stillpoint {
namespace {

/// Points with these ids walk sideways at 0.5 m/s; about a sixth of all.
bool walks(std::int64_t id) { return id % 6 == 0; }

/// The picture with the walkers moved on since t = 0; their depth stays.
TrackedFrame picture_with_walkers(const SimulatedFlight& flight, std::int64_t id, double t) {
  TrackedFrame frame = flight.picture(id, t);
  const Camera camera = SimulatedFlight::rig().camera;
  for (TrackedFeature& feature : frame.features) {
    if (!walks(feature.id)) continue;
    feature.bearing.x() += 0.5 * t / feature.depth;
    feature.pixel = camera.project(feature.bearing.homogeneous());
  }
  std::erase_if(frame.features, [&](const TrackedFeature& f) { return !camera.contains(f.pixel); });
  return frame;
}

OdometryConfig config_with(bool moving_consistency) {
  OdometryConfig config;
  config.backend.rate_hz = 0.0;
  config.backend.depth.usage = DepthUsage::kWeighted;
  config.backend.initializer.kind = InitializerKind::kInstant;
  config.dynamic.moving_consistency = moving_consistency;
  config.dynamic.gate_before_solve = moving_consistency;
  return config;
}

struct Outcome {
  double error_m = 0.0;                          ///< of the last position relative to the first reported one
  std::map<std::int64_t, Verdict> last_verdict;  ///< of the features in the last picture
  OdometryUpdate last;
};

Outcome fly(const OdometryConfig& config, const std::vector<DetectionSet>& detections = {}) {
  const SimulatedFlight flight{.pixel_noise_px = 0.2, .depth_noise = 0.002};
  OptimizationStage stage(config, SimulatedFlight::rig());
  for (const ImuSample& sample : flight.imu(4.0)) stage.add_imu(sample);
  std::optional<Pose> T_first, T_first_true;
  Outcome outcome;
  for (int i = 0; i < 75; ++i) {
    const double t = 0.1 + i / 30.0;
    const DetectionSet boxes = detections.empty() ? DetectionSet{} : detections[static_cast<std::size_t>(i)];
    outcome.last = stage.process(picture_with_walkers(flight, i, t), boxes);
    if (outcome.last.status != OdometryStatus::kTracking) continue;
    const Pose truth = SimulatedFlight::state(t).T_w_b;
    if (!T_first) {
      T_first = outcome.last.state.T_w_b;
      T_first_true = truth;
    }
    outcome.error_m =
        ((T_first->inverse() * outcome.last.state.T_w_b).p - (T_first_true->inverse() * truth).p).norm();
  }
  for (const FeatureVerdict& verdict : stage.dynamic().verdicts)
    outcome.last_verdict[verdict.id] = verdict.verdict;
  return outcome;
}

TEST(OptimizationStage, FindsWalkersByTheirMotionAndNothingElse) {
  const Outcome outcome = fly(config_with(true));
  int found = 0, walkers = 0, falsely = 0, still = 0;
  for (const auto& [id, verdict] : outcome.last_verdict) {
    const bool moves = verdict != Verdict::kStable;
    (walks(id) ? walkers : still) += 1;
    (walks(id) ? found : falsely) += moves;
  }
  ASSERT_GE(walkers, 5);
  EXPECT_EQ(found, walkers);
  EXPECT_LE(falsely, still / 20);
  EXPECT_EQ(outcome.last.counters.dynamic_features, found + falsely);
  EXPECT_LT(outcome.error_m, 0.01);
}

TEST(OptimizationStage, WithoutTheCheckNothingIsFlaggedWithoutBoxes) {
  const Outcome outcome = fly(config_with(false));
  for (const auto& [id, verdict] : outcome.last_verdict) EXPECT_EQ(verdict, Verdict::kStable) << id;
}

TEST(OptimizationStage, ABoxKeepsItsFeaturesOutOfTheSolve) {
  OdometryConfig config = config_with(false);
  const Outcome seen = fly(config);
  // A box over the left half, in every picture; nothing has a depth picture, so everything in it is dynamic.
  const Detection person{.class_name = "person", .score = 1.0, .box = {0.0, 0.0, 320.0, 479.0}};
  const std::vector<DetectionSet> boxes(75, DetectionSet{{}, DetectionState::kPresent, {person}});
  const Outcome masked = fly(config, boxes);
  EXPECT_GT(masked.last.counters.dynamic_features, 0);
  EXPECT_LT(masked.last.counters.window_landmarks, seen.last.counters.window_landmarks * 3 / 4);
  config.dynamic.mask = DynamicMask::kOff;
  EXPECT_EQ(fly(config, boxes).last.counters.dynamic_features, 0);
}

TEST(OptimizationStage, CountsOneCallOfEachModuleAPicture) {
  const Outcome outcome = fly(config_with(true));
  EXPECT_EQ(outcome.last.timings[Module::kDynamicRecognition].calls, 1);
  EXPECT_EQ(outcome.last.timings[Module::kStateOptimization].calls, 1);
  EXPECT_EQ(outcome.last.timings[Module::kOptimizationThread].calls, 1);
  EXPECT_GE(outcome.last.timings[Module::kOptimizationThread].ns,
            outcome.last.timings[Module::kStateOptimization].ns +
                outcome.last.timings[Module::kDynamicRecognition].ns);
}

}  // namespace
}  // namespace stillpoint
