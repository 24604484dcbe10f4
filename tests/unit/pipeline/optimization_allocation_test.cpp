// SPDX-License-Identifier: BSD-3-Clause
// The optimization stage is allocation-free in the steady state, with the default configurations.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/config/config_file.h"
#include "bench/profile/meters/allocation_counter.h"
#include "core/pipeline/stages/optimization_stage.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

constexpr int kRounds = 12;
constexpr int kFramesPerRound = 40;
constexpr double kInterval_s = 0.05;

/// Frames in which a point that reappears gets a new feature id. Some points have no depth, others oscillate
/// sideways.
class Tracks {
 public:
  explicit Tracks(const SimulatedMotion& motion)
      : motion_(motion), wall_(480, 640, CV_16UC1, cv::Scalar(3000)) {}

  TrackedFrame frame_at(std::int64_t index) {
    TrackedFrame frame =
        motion_.frame(index % kFramesPerRound, 0.1 + kInterval_s * static_cast<double>(index));
    frame.id = index;
    frame.depth = wall_;
    for (TrackedFeature& feature : frame.features) {
      Track& track = tracks_[static_cast<std::size_t>(feature.id)];
      if (track.last_frame != index - 1) track.id = next_id_++;
      track.last_frame = index;
      if (feature.id % 7 == 0) feature.depth = 0.0;
      if (feature.id % 11 == 0) {
        feature.bearing.x() += 0.05 * std::sin(2.0 * M_PI * static_cast<double>(index) / kFramesPerRound);
        feature.pixel = SimulatedMotion::rig().camera.project(feature.bearing.homogeneous());
      }
      feature.id = track.id;
    }
    std::ranges::sort(frame.features, {}, &TrackedFeature::id);
    return frame;
  }

 private:
  struct Track {
    std::int64_t id = 0;
    std::int64_t last_frame = -2;
  };
  const SimulatedMotion& motion_;
  cv::Mat wall_;
  std::int64_t next_id_ = 0;
  std::vector<Track> tracks_ = std::vector<Track>(static_cast<std::size_t>(motion_.points));
};

/// A walking person, undetected in every fifth frame, and another one at the image border.
DetectionSet boxes(std::int64_t index) {
  const auto step = static_cast<double>(index % kFramesPerRound);
  const double x = 200.0 + 5.0 * std::min(step, kFramesPerRound - step);
  DetectionSet set{.t = {}, .state = DetectionState::kPresent, .detections = {}};
  set.detections.push_back({.class_name = "person", .score = 0.9, .box = {600.0, 100.0, 700.0, 400.0}});
  if (index % 5 != 0) {
    set.detections.push_back({.class_name = "person", .score = 0.9, .box = {x, 100.0, x + 120.0, 400.0}});
  }
  return set;
}

struct Counts {
  std::size_t first_round = 0;
  std::size_t last_round = 0;
  int keyframes = 0;  ///< in the last round
  int moving = 0;     ///< labels in the last round: dynamic by motion
  int tracked = 0;    ///< frames tracked in the last round
};

Counts run_periodic_motion(const std::string& variant) {
  const SimulatedMotion motion{.pixel_noise_px = 0.3,
                               .depth_noise = 0.003,
                               .noisy_imu = true,
                               .ping_pong_period_s = kFramesPerRound * kInterval_s};
  Tracks tracks(motion);
  OptimizationStage stage(bench::load_config({.base = "stillpoint", .variant = variant, .settings = {}}),
                          SimulatedMotion::rig());
  Feedback feedback;
  Counts counts;
  const std::vector<ImuSample> imu = motion.imu(kRounds * kFramesPerRound * kInterval_s + 0.2);
  auto sample = imu.begin();
  for (int index = 0; index < kRounds * kFramesPerRound; ++index) {
    const TrackedFrame frame = tracks.frame_at(index);
    const DetectionSet detections = boxes(index);
    const std::size_t before = bench::allocation_count();
    for (; sample != imu.end() && sample->t <= after(frame.t, 0.02); ++sample) stage.add_imu(*sample);
    const OdometryUpdate& update = stage.process(frame, detections);
    feedback = stage.feedback(std::move(feedback));
    const std::size_t allocations = bench::allocation_count() - before;
    if (index < kFramesPerRound) counts.first_round += allocations;
    if (index < (kRounds - 1) * kFramesPerRound) continue;
    counts.last_round += allocations;
    counts.keyframes += update.counters.keyframe;
    counts.moving += static_cast<int>(
        std::ranges::count(stage.dynamic().labels, LabelClass::kDynamicMotion, &DynamicLabel::label));
    counts.tracked += is_located(update.status);
  }
  return counts;
}

class OptimizationStageWith : public testing::TestWithParam<std::string> {};

TEST_P(OptimizationStageWith, IsAllocationFreeInTheSteadyState) {
  const Counts counts = run_periodic_motion(GetParam());
  EXPECT_EQ(counts.last_round, 0u);
  EXPECT_GT(counts.first_round, 100u);  // the counter works
  // All code paths were executed: both kinds of marginalization, and dynamic features.
  EXPECT_EQ(counts.tracked, kFramesPerRound);
  EXPECT_GT(counts.keyframes, 0);
  EXPECT_LT(counts.keyframes, kFramesPerRound);
  EXPECT_GT(counts.moving, 0);
}

INSTANTIATE_TEST_SUITE_P(Settings, OptimizationStageWith,
                         testing::Values("", "vo", "bearing_time_offset", "published_prior"),
                         [](const auto& variant) {
                           return variant.param.empty() ? "stillpoint" : variant.param;
                         });

}  // namespace
}  // namespace stillpoint
