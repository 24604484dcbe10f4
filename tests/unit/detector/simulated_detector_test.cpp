// SPDX-License-Identifier: BSD-3-Clause
#include "core/detector/playback_detectors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/detector/blank_frame.h"

namespace stillpoint {
namespace {

constexpr int kFrames = 3000;

/// A person moving 0.1 px per frame, and a dog.
std::vector<DetectionSet> truth() {
  std::vector<DetectionSet> sets;
  for (int id = 0; id < kFrames; ++id) {
    const double x = 100 + 0.1 * id;
    sets.push_back(
        {.t = blank_frame(id).t,
         .state = DetectionState::kPresent,
         .detections = {
             {.class_name = "person", .box = {.x_min = x, .y_min = 100, .x_max = x + 80, .y_max = 300}},
             {.class_name = "dog", .box = {.x_min = 300, .y_min = 300, .x_max = 400, .y_max = 400}}}});
  }
  return sets;
}

DetectorConfig without_errors() {
  DetectorConfig config;
  config.simulated = {
      .miss_rate = 0.0, .burst_frames = 1, .latency_s = 0.0, .jitter_px = 0.0, .false_positive_rate = 0.0};
  return config;
}

/// For each frame whether the class was detected.
std::vector<bool> detected(SimulatedDetector& detector, const std::string& class_name) {
  std::vector<bool> result;
  for (int id = 0; id < kFrames; ++id) {
    bool found = false;
    for (const Detection& detection : detector.detect(blank_frame(id)).detections)
      found = found || detection.class_name == class_name;
    result.push_back(found);
  }
  return result;
}

double miss_rate(const std::vector<bool>& detected) {
  return static_cast<double>(std::count(detected.begin(), detected.end(), false)) /
         static_cast<double>(detected.size());
}

TEST(SimulatedDetector, ReturnsTheGroundTruthWithoutErrors) {
  const auto sets = truth();
  SimulatedDetector detector(sets, without_errors(), 1);
  const DetectionSet found = detector.detect(blank_frame(40));
  EXPECT_EQ(found.state, DetectionState::kPresent);
  ASSERT_EQ(found.detections.size(), 2U);
  EXPECT_EQ(found.detections[0].box, sets[40].detections[0].box);
  EXPECT_EQ(found.detections[1].class_name, "dog");
}

TEST(SimulatedDetector, HasTheConfiguredMissRate) {
  const auto sets = truth();
  DetectorConfig config = without_errors();
  config.simulated.miss_rate = 0.15;
  SimulatedDetector detector(sets, config, 1);
  // 3000 draws: standard deviation sqrt(0.15 * 0.85 / 3000) = 0.0065; tolerance 4 sigma.
  EXPECT_NEAR(miss_rate(detected(detector, "person")), 0.15, 0.026);
}

TEST(SimulatedDetector, MissesInBursts) {
  const auto sets = truth();
  DetectorConfig config = without_errors();
  config.simulated.miss_rate = 0.15;
  config.simulated.burst_frames = 6;
  SimulatedDetector detector(sets, config, 1);
  const std::vector<bool> person = detected(detector, "person");
  std::vector<int> lengths;  // of bursts that start and end within the sequence
  for (std::size_t i = 1, run = 0; i < person.size(); ++i) {
    if (!person[i]) ++run;
    if (person[i] && run > 0 && i > run) lengths.push_back(static_cast<int>(run));
    if (person[i]) run = 0;
  }
  ASSERT_GT(lengths.size(), 20U);
  for (const int length : lengths) EXPECT_EQ(length % 6, 0) << length;
  EXPECT_NE(person, detected(detector, "dog")) << "misses of different objects are independent";
}

TEST(SimulatedDetector, ErrorsOfAFrameDoNotDependOnTheOrder) {
  const auto sets = truth();
  DetectorConfig config = without_errors();
  config.simulated = {
      .miss_rate = 0.3, .burst_frames = 3, .latency_s = 0.0, .jitter_px = 3.0, .false_positive_rate = 0.3};
  SimulatedDetector forward(sets, config, 7), backward(sets, config, 7), other_seed(sets, config, 8);
  std::vector<DetectionSet> first(100), second(100);
  for (int id = 0; id < 100; ++id) first[static_cast<std::size_t>(id)] = forward.detect(blank_frame(id));
  for (int id = 99; id >= 0; --id) second[static_cast<std::size_t>(id)] = backward.detect(blank_frame(id));
  bool differs = false;
  for (std::size_t id = 0; id < 100; ++id) {
    ASSERT_EQ(first[id].detections.size(), second[id].detections.size()) << id;
    for (std::size_t k = 0; k < first[id].detections.size(); ++k)
      EXPECT_EQ(first[id].detections[k].box, second[id].detections[k].box) << id;
    differs = differs || first[id].detections.size() !=
                             other_seed.detect(blank_frame(static_cast<std::int64_t>(id))).detections.size();
  }
  EXPECT_TRUE(differs);
}

TEST(SimulatedDetector, JittersEdgesWithTheConfiguredDeviation) {
  const auto sets = truth();
  DetectorConfig config = without_errors();
  config.simulated.jitter_px = 2.0;
  SimulatedDetector detector(sets, config, 1);
  double sum = 0.0, squares = 0.0;
  for (int id = 0; id < kFrames; ++id) {
    const double error = detector.detect(blank_frame(id)).detections.at(1).box.x_min - 300.0;
    sum += error;
    squares += error * error;
  }
  // Standard errors of 3000 draws: mean 2 / sqrt(3000) = 0.037, deviation 2 / sqrt(6000) = 0.026; tolerance 4
  // sigma.
  EXPECT_NEAR(sum / kFrames, 0.0, 0.15);
  EXPECT_NEAR(std::sqrt(squares / kFrames), 2.0, 0.11);
}

TEST(SimulatedDetector, DelaysBoxesByTheLatency) {
  const auto sets = truth();
  DetectorConfig config = without_errors();
  config.simulated.latency_s = 0.1;  // three frames
  SimulatedDetector detector(sets, config, 1);
  EXPECT_EQ(detector.detect(blank_frame(2)).state, DetectionState::kLate);
  EXPECT_EQ(detector.detect(blank_frame(40)).detections.at(0).box, sets[37].detections[0].box);
  EXPECT_EQ(detector.counters().skipped, 1);
}

TEST(SimulatedDetector, AddsFalsePositives) {
  DetectorConfig config = without_errors();
  config.simulated.false_positive_rate = 0.2;
  const std::vector empty_room = {DetectionSet{.t = blank_frame(0).t, .state = DetectionState::kPresent}};
  SimulatedDetector detector(empty_room, config, 1);
  for (int id = 0; id < kFrames; ++id) {
    for (const Detection& detection : detector.detect(blank_frame(id)).detections)
      EXPECT_EQ(detection.class_name, "person");
  }
  // Standard deviation sqrt(0.2 * 0.8 / 3000) = 0.0073; tolerance 4 sigma.
  EXPECT_NEAR(static_cast<double>(detector.counters().boxes) / kFrames, 0.2, 0.03);
  EXPECT_EQ(detector.counters().clipped, 0);
}

}  // namespace
}  // namespace stillpoint
