// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sensors/sensor_models.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stillpoint::synth {
namespace {

TEST(VisibleObjects, BoxesEncloseExactlyTheLabeledPixels) {
  RenderedFrame frame{8, 6, {}, {}, std::vector<std::uint16_t>(48)};
  for (const auto& [row, column] : {std::pair{1, 2}, {3, 5}, {2, 4}}) {
    frame.object[static_cast<std::size_t>(row * 8 + column)] = 3;
  }
  frame.object[5 * 8] = datasets::kFirstUndetectableObject;
  const std::vector<VisibleObject> visible = visible_objects(frame);
  ASSERT_EQ(visible.size(), 2U);
  EXPECT_EQ(visible[0].object, 3);
  EXPECT_EQ(visible[0].pixels, 3);
  EXPECT_DOUBLE_EQ(visible[0].box.x_min, 1.5);  // pixel i covers [i - 0.5, i + 0.5]
  EXPECT_DOUBLE_EQ(visible[0].box.x_max, 5.5);
  EXPECT_DOUBLE_EQ(visible[0].box.y_min, 0.5);
  EXPECT_DOUBLE_EQ(visible[0].box.y_max, 3.5);
  EXPECT_EQ(visible[1].object, datasets::kFirstUndetectableObject);
}

std::vector<std::vector<VisibleObject>> one_person(int frames, int object) {
  return {static_cast<std::size_t>(frames), {{object, 5000, {100.0, 50.0, 180.0, 250.0}}}};
}

std::vector<std::vector<Detection>> simulate_detector(const std::vector<std::vector<VisibleObject>>& frames,
                                                      const DetectorModel& model) {
  SimulatedPersonDetector detector(model, {640, 480}, 9);
  std::vector<std::vector<Detection>> reports;
  for (const std::vector<VisibleObject>& visible : frames) reports.push_back(detector.detect(visible));
  return reports;
}

TEST(SimulatedDetector, MissesTheConfiguredFractionInBursts) {
  const DetectorModel model{.miss_rate = 0.15, .burst_frames = 4.0, .false_positive_rate = 0.0};
  constexpr int kFrames = 40000;
  const auto reports = simulate_detector(one_person(kFrames, 1), model);
  int missed = 0, bursts = 0;
  bool before = false;
  for (const auto& report : reports) {
    missed += report.empty() ? 1 : 0;
    bursts += report.empty() && !before ? 1 : 0;
    before = report.empty();
  }
  // About 1500 bursts: 3 % standard error of their mean length.
  EXPECT_NEAR(static_cast<double>(missed) / kFrames, 0.15, 0.015);
  EXPECT_NEAR(static_cast<double>(missed) / bursts, 4.0, 0.4);
}

TEST(SimulatedDetector, EdgeJitterScalesWithTheBoxSize) {
  const DetectorModel model{.miss_rate = 0.0, .jitter_ratio = 0.02, .false_positive_rate = 0.0};
  const auto reports = simulate_detector(one_person(5000, 1), model);
  double squares = 0.0;
  for (const auto& report : reports) squares += std::pow(report.front().box.y_min - 50.0, 2);
  EXPECT_NEAR(std::sqrt(squares / 5000.0), 0.02 * 200.0, 0.15);  // 1 % standard error
}

TEST(SimulatedDetector, NeverReportsUnknownClasses) {
  const DetectorModel model{.miss_rate = 0.0, .false_positive_rate = 0.0};
  for (const auto& report : simulate_detector(one_person(50, datasets::kFirstUndetectableObject), model)) {
    EXPECT_TRUE(report.empty());
  }
}

TEST(SimulatedDetector, ReportsFalsePositivesAtTheConfiguredRate) {
  const DetectorModel model{.false_positive_rate = 0.1};
  const std::vector<std::vector<VisibleObject>> empty(10000);
  std::size_t boxes = 0;
  for (const auto& report : simulate_detector(empty, model)) boxes += report.size();
  EXPECT_NEAR(static_cast<double>(boxes), 1000.0, 100.0);  // binomial: sigma 30
}

}  // namespace
}  // namespace stillpoint::synth
