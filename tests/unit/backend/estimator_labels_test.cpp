// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>

#include "core/backend/estimator.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

/// Labels the features of a frame with even ids as dynamic, and records what it is asked for.
class EvenFeatures final : public DynamicLabeler {
 public:
  explicit EvenFeatures(bool uses_prediction) : uses_prediction_(uses_prediction) {}

  Labels labels_by_detections(const TrackedFrame& frame) override {
    calls += 'd';
    labels_.clear();
    for (const TrackedFeature& feature : frame.features) {
      labels_.push_back({.id = feature.id,
                         .label = feature.id % 2 == 0 ? LabelClass::kDynamicObject : LabelClass::kStable});
    }
    return labels_;
  }
  bool uses_prediction() const override { return uses_prediction_; }
  Labels labels_at_prediction(const Window& window, const std::optional<UncertainPose>&) override {
    calls += window.inertial ? 'p' : '?';
    return {};
  }
  Labels labels_after_refinement(const RefinedWindow& refined) override {
    calls += refined.failed ? 'f' : 'r';
    return {};
  }

  std::string calls;

 private:
  bool uses_prediction_;
  std::vector<DynamicLabel> labels_;
};

/// What the estimator asks for in each of 20 frames.
std::string calls_of(bool uses_prediction) {
  BackendConfig config;
  config.depth.usage = DepthUsage::kWeighted;
  config.initializer.kind = InitializerKind::kInstant;
  Estimator estimator(config, {}, SimulatedMotion::rig(), 1);
  const SimulatedMotion motion;
  for (const ImuSample& sample : motion.imu(2.0)) estimator.add_imu(sample);
  EvenFeatures dynamic(uses_prediction);
  for (int i = 0; i < 20; ++i) {
    estimator.process(motion.frame(i, 0.1 + i / 30.0), &dynamic);
    for (const Landmark& landmark : estimator.window().landmarks)
      EXPECT_EQ(landmark.dynamic, landmark.id % 2 == 0);
  }
  return dynamic.calls;
}

TEST(EstimatorLabels, AreAskedForBeforeAndAfterTheOptimization) {
  const std::string calls = calls_of(false);
  ASSERT_EQ(calls.size(), 40U);
  EXPECT_EQ(calls.substr(0, 4), "drdr");
}

TEST(EstimatorLabels, AreAskedForAtThePredictedPoseOnceTheWindowIsInertial) {
  const std::string calls = calls_of(true);
  EXPECT_EQ(calls.substr(0, 2), "dr");
  EXPECT_EQ(calls.substr(calls.size() - 6), "dprdpr");
  EXPECT_EQ(calls.find('?'), std::string::npos);
}

}  // namespace
}  // namespace stillpoint
