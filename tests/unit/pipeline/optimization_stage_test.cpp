// SPDX-License-Identifier: BSD-3-Clause
// Labels in a simulated run with moving points, and their effect on the estimate.
#include "core/pipeline/stages/optimization_stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/support/published_config.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

/// Points with these ids move sideways at 0.5 m/s: one sixth of all points.
bool moves(std::int64_t id) { return id % 6 == 0; }

/// Frame with the moving points displaced since t = 0, at constant depth.
TrackedFrame frame_with_moving_points(const SimulatedMotion& motion, std::int64_t id, double t) {
  TrackedFrame frame = motion.frame(id, t);
  const Camera camera = SimulatedMotion::rig().camera;
  for (TrackedFeature& feature : frame.features) {
    if (!moves(feature.id)) continue;
    feature.bearing.x() += 0.5 * t / feature.depth;
    feature.pixel = camera.project(feature.bearing.homogeneous());
  }
  std::erase_if(frame.features, [&](const TrackedFeature& f) { return !camera.contains(f.pixel); });
  return frame;
}

OdometryConfig config_with(bool moving_consistency) {
  OdometryConfig config = published_config();
  config.backend.rate_hz = 0.0;
  config.backend.depth.usage = DepthUsage::kWeighted;
  config.backend.initializer.kind = InitializerKind::kInstant;
  config.dynamic.moving_consistency = moving_consistency;
  config.dynamic.gate_before_solve = moving_consistency;
  return config;
}

struct Outcome {
  double error_m = 0.0;  ///< of the last position relative to the first reported one
  std::map<std::int64_t, LabelClass> last_labels;  ///< of the features in the last frame
  OdometryUpdate last;
};

Outcome run(const OdometryConfig& config, const std::vector<DetectionSet>& detections = {}) {
  const SimulatedMotion motion{.pixel_noise_px = 0.2, .depth_noise = 0.002};
  OptimizationStage stage(config, SimulatedMotion::rig());
  for (const ImuSample& sample : motion.imu(4.0)) stage.add_imu(sample);
  std::optional<Pose> T_first, T_first_true;
  Outcome outcome;
  for (int i = 0; i < 75; ++i) {
    const double t = 0.1 + i / 30.0;
    const DetectionSet boxes = detections.empty() ? DetectionSet{} : detections[static_cast<std::size_t>(i)];
    outcome.last = stage.process(frame_with_moving_points(motion, i, t), boxes);
    if (outcome.last.status != OdometryStatus::kTracking) continue;
    const Pose truth = SimulatedMotion::state(t).T_w_b;
    if (!T_first) {
      T_first = outcome.last.state.T_w_b;
      T_first_true = truth;
    }
    outcome.error_m =
        ((T_first->inverse() * outcome.last.state.T_w_b).p - (T_first_true->inverse() * truth).p).norm();
  }
  for (const DynamicLabel& label : stage.dynamic().labels) outcome.last_labels[label.id] = label.label;
  return outcome;
}

TEST(OptimizationStage, LabelsMovingPointsOnly) {
  const Outcome outcome = run(config_with(true));
  int found = 0, moving_points = 0, false_positives = 0, static_points = 0;
  for (const auto& [id, label] : outcome.last_labels) {
    const bool is_dynamic = label != LabelClass::kStable;
    (moves(id) ? moving_points : static_points) += 1;
    (moves(id) ? found : false_positives) += is_dynamic;
  }
  ASSERT_GE(moving_points, 5);
  EXPECT_EQ(found, moving_points);
  EXPECT_LE(false_positives, static_points / 20);
  EXPECT_EQ(outcome.last.counters.dynamic_features, found + false_positives);
  EXPECT_LT(outcome.error_m, 0.01);
}

TEST(OptimizationStage, LabelsNothingWithoutTheCheckAndWithoutBoxes) {
  const Outcome outcome = run(config_with(false));
  for (const auto& [id, label] : outcome.last_labels) EXPECT_EQ(label, LabelClass::kStable) << id;
}

TEST(OptimizationStage, ExcludesFeaturesInABoxFromTheEstimate) {
  OdometryConfig config = config_with(false);
  const Outcome unmasked = run(config);
  // A box over the left half of every frame; without a depth image all features in it are dynamic.
  const Detection person{.class_name = "person", .score = 1.0, .box = {0.0, 0.0, 320.0, 479.0}};
  const std::vector<DetectionSet> boxes(75, DetectionSet{{}, DetectionState::kPresent, {person}});
  const Outcome masked = run(config, boxes);
  EXPECT_GT(masked.last.counters.dynamic_features, 0);
  EXPECT_LT(masked.last.counters.window_landmarks, unmasked.last.counters.window_landmarks * 3 / 4);
  config.dynamic.mask = DynamicMask::kOff;
  EXPECT_EQ(run(config, boxes).last.counters.dynamic_features, 0);
}

TEST(OptimizationStage, CountsOneCallOfEachModulePerFrame) {
  const Outcome outcome = run(config_with(true));
  EXPECT_EQ(outcome.last.timings[Module::kDynamicRecognition].calls, 1);
  EXPECT_EQ(outcome.last.timings[Module::kStateOptimization].calls, 1);
  EXPECT_EQ(outcome.last.timings[Module::kOptimizationThread].calls, 1);
  EXPECT_GE(outcome.last.timings[Module::kOptimizationThread].ns,
            outcome.last.timings[Module::kStateOptimization].ns +
                outcome.last.timings[Module::kDynamicRecognition].ns);
}

}  // namespace
}  // namespace stillpoint
