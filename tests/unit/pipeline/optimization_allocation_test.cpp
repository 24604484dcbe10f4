// SPDX-License-Identifier: BSD-3-Clause
// The optimisation asks for no memory once it has held as much as it needs, with the settings that are
// shipped.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/config/config_file.h"
#include "bench/profile/allocation_counter.h"
#include "core/pipeline/optimization_stage.h"
#include "tests/support/simulated_flight.h"

namespace stillpoint {
namespace {

constexpr int kRounds = 12;
constexpr int kPicturesOfARound = 40;
constexpr double kInterval_s = 0.05;

/// Pictures in which a point that comes back is a new feature. Some points have no depth, others swing from
/// side to side.
class Tracks {
 public:
  explicit Tracks(const SimulatedFlight& flight)
      : flight_(flight), wall_(480, 640, CV_16UC1, cv::Scalar(3000)) {}

  TrackedFrame picture(std::int64_t index) {
    TrackedFrame frame =
        flight_.picture(index % kPicturesOfARound, 0.1 + kInterval_s * static_cast<double>(index));
    frame.id = index;
    frame.depth = wall_;
    for (TrackedFeature& feature : frame.features) {
      Track& track = tracks_[static_cast<std::size_t>(feature.id)];
      if (track.last_seen != index - 1) track.id = next_id_++;
      track.last_seen = index;
      if (feature.id % 7 == 0) feature.depth = 0.0;
      if (feature.id % 11 == 0) {
        feature.bearing.x() += 0.05 * std::sin(2.0 * M_PI * static_cast<double>(index) / kPicturesOfARound);
        feature.pixel = SimulatedFlight::rig().camera.project(feature.bearing.homogeneous());
      }
      feature.id = track.id;
    }
    std::ranges::sort(frame.features, {}, &TrackedFeature::id);
    return frame;
  }

 private:
  struct Track {
    std::int64_t id = 0;
    std::int64_t last_seen = -2;
  };
  const SimulatedFlight& flight_;
  cv::Mat wall_;
  std::int64_t next_id_ = 0;
  std::vector<Track> tracks_ = std::vector<Track>(static_cast<std::size_t>(flight_.points));
};

/// A person on the way to and fro who is missed in every fifth picture, and another at the edge.
DetectionSet boxes(std::int64_t index) {
  const auto step = static_cast<double>(index % kPicturesOfARound);
  const double x = 200.0 + 5.0 * std::min(step, kPicturesOfARound - step);
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
  int keyframes = 0;  ///< of the last round
  int movers = 0;     ///< likewise, outside of boxes
  int tracked = 0;    ///< likewise
};

Counts fly_to_and_fro(const std::string& variant) {
  const SimulatedFlight flight{.pixel_noise_px = 0.3,
                               .depth_noise = 0.003,
                               .noisy_imu = true,
                               .period_s = kPicturesOfARound * kInterval_s};
  Tracks tracks(flight);
  OptimizationStage stage(load_config({.base = "stillpoint", .variant = variant, .settings = {}}),
                          SimulatedFlight::rig());
  Feedback feedback;
  Counts counts;
  const std::vector<ImuSample> imu = flight.imu(kRounds * kPicturesOfARound * kInterval_s + 0.2);
  auto sample = imu.begin();
  for (int index = 0; index < kRounds * kPicturesOfARound; ++index) {
    const TrackedFrame frame = tracks.picture(index);
    const DetectionSet detections = boxes(index);
    const std::size_t before = allocation_count();
    for (; sample != imu.end() && sample->t <= after(frame.t, 0.02); ++sample) stage.add_imu(*sample);
    const OdometryUpdate& update = stage.process(frame, detections);
    feedback = stage.feedback(std::move(feedback));
    const std::size_t asked = allocation_count() - before;
    if (index < kPicturesOfARound) counts.first_round += asked;
    if (index < (kRounds - 1) * kPicturesOfARound) continue;
    counts.last_round += asked;
    counts.keyframes += update.counters.keyframe;
    counts.movers += static_cast<int>(
        std::ranges::count(stage.dynamic().verdicts, Verdict::kDynamicMotion, &FeatureVerdict::verdict));
    counts.tracked += update.status == OdometryStatus::kTracking;
  }
  return counts;
}

class OptimizationStageIn : public testing::TestWithParam<std::string> {};

TEST_P(OptimizationStageIn, AllocatesNothingOnceItHasHeldAsMuch) {
  const Counts counts = fly_to_and_fro(GetParam());
  EXPECT_EQ(counts.last_round, 0u);
  EXPECT_GT(counts.first_round, 100u);  // the counter counts
  // There was everything to do: both ways by which frames leave, and movers to be kept out.
  EXPECT_EQ(counts.tracked, kPicturesOfARound);
  EXPECT_GT(counts.keyframes, 0);
  EXPECT_LT(counts.keyframes, kPicturesOfARound);
  EXPECT_GT(counts.movers, 0);
}

INSTANTIATE_TEST_SUITE_P(Settings, OptimizationStageIn, testing::Values("", "vo"),
                         [](const auto& variant) { return variant.param.empty() ? "Inertial" : "Visual"; });

}  // namespace
}  // namespace stillpoint
