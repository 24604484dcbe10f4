// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/stages/replication.h"

#include <gtest/gtest.h>

#include "core/pipeline/runners/runner.h"
#include "tests/support/simulated/inertial_plane.h"

namespace stillpoint {
namespace {

constexpr double kFocalPx = 150.0;
const ImuSample kSample{
    .t = Timestamp{1'000'000'000}, .gyro_b = {0.3, -2.0, 7.0}, .accel_b = {1.0, 2.0, 9.0}};

TrackedFrame frame_at(Timestamp t) {
  TrackedFrame frame{.id = 3, .t = t};
  frame.features = {{.id = 7, .pixel = {400.0, 300.0}, .bearing = {0.5, -0.25}},
                    {.id = 8, .pixel = {400.0, 300.0}, .bearing = {0.5, -0.25}}};
  return frame;
}

TEST(InputPerturbation, ChangesNothingWithSeedZero) {
  const InputPerturbation none(0, kFocalPx);
  EXPECT_EQ(none.of(kSample).gyro_b, kSample.gyro_b);
  TrackedFrame frame = frame_at(kSample.t);
  none.perturb(frame);
  EXPECT_EQ(frame.features.front().pixel, frame_at(kSample.t).features.front().pixel);
  EXPECT_EQ(frame.features.front().bearing, frame_at(kSample.t).features.front().bearing);
}

TEST(InputPerturbation, ChangesAngularRatesByLessThan1e9) {
  const ImuSample perturbed = InputPerturbation(1, kFocalPx).of(kSample);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NE(perturbed.gyro_b[axis], kSample.gyro_b[axis]);
    EXPECT_NEAR(perturbed.gyro_b[axis] / kSample.gyro_b[axis], 1.0, 1.001e-9);
  }
  EXPECT_EQ(perturbed.accel_b, kSample.accel_b);
}

TEST(InputPerturbation, MovesPixelAndBearingOfAFeatureByTheSameAngle) {
  TrackedFrame frame = frame_at(kSample.t);
  InputPerturbation(1, kFocalPx).perturb(frame);
  const TrackedFeature original = frame_at(kSample.t).features.front();
  for (const TrackedFeature& feature : frame.features) {
    const Eigen::Vector2d moved_px = feature.pixel - original.pixel;
    EXPECT_NE(moved_px.x(), 0.0);
    EXPECT_NE(moved_px.y(), 0.0);
    EXPECT_LT(moved_px.cwiseAbs().maxCoeff(), 400.0 * 1.001e-9);
    // The bearing differs from the pixel by the rounding of 0.5 and 400, 1e-16 and 1e-13.
    EXPECT_NEAR((feature.bearing - original.bearing - moved_px / kFocalPx).norm(), 0.0, 1e-14);
  }
  EXPECT_NE(frame.features[0].pixel, frame.features[1].pixel);  // depends on the id
}

TEST(InputPerturbation, DependsOnSeedAndTimeOnly) {
  const InputPerturbation one(1, kFocalPx);
  const InputPerturbation two(2, kFocalPx);
  ImuSample later = kSample;
  later.t.ns += 5'000'000;
  EXPECT_EQ(one.of(kSample).gyro_b, one.of(kSample).gyro_b);
  EXPECT_NE(one.of(kSample).gyro_b, two.of(kSample).gyro_b);
  EXPECT_NE(one.of(kSample).gyro_b, one.of(later).gyro_b);
}

/// Hash of the state after each frame.
template <class Run>
std::vector<std::uint64_t> state_hashes(const Run& run, int perturbation_seed) {
  const SlidingPlane plane(20);
  OdometryConfig config = visual_config();
  config.pipeline.perturbation_seed = perturbation_seed;
  std::vector<std::uint64_t> hashes;
  static_cast<void>(run(plane.input(), config, {.on_frame = {[&](const FrameReport& report) {
                                                  hashes.push_back(report.update.hashes.optimization);
                                                }}}));
  return hashes;
}

TEST(InputPerturbation, GivesReproducibleReplicates) {
  const std::vector<std::uint64_t> none = state_hashes(run_sequential, 0);
  const std::vector<std::uint64_t> one = state_hashes(run_sequential, 1);
  ASSERT_EQ(none.size(), 20u);
  EXPECT_NE(one.back(), none.back());
  EXPECT_NE(one.back(), state_hashes(run_sequential, 2).back());
  EXPECT_EQ(one, state_hashes(run_sequential, 1));
  EXPECT_EQ(one, state_hashes(run_pipelined, 1));
}

}  // namespace
}  // namespace stillpoint
