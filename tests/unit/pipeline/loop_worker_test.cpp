// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/loop_worker.h"

#include <gtest/gtest.h>

#include "core/pipeline/odometry.h"
#include "core/pipeline/threaded_odometry.h"
#include "tests/support/simulated/inertial_plane.h"

namespace stillpoint {
namespace {

constexpr int kFrames = 120;  // 60 to the right, 60 back

struct Corrected {
  std::vector<Eigen::Vector3d> odometry;
  std::vector<Eigen::Vector3d> corrections;
  std::vector<LoopRecord> loops;

  void add(const OdometryUpdate& update) {
    odometry.push_back(update.T_w_c.p);
    corrections.push_back(update.T_m_w.p);
  }
  [[nodiscard]] std::ptrdiff_t first_correction() const {
    return std::ranges::find_if(corrections, [](const auto& p) { return !p.isZero(0.0); }) -
           corrections.begin();
  }
};

Frame returning_frame(const SlidingPlane& plane, int k) {
  Frame frame = plane.frame(static_cast<std::size_t>(std::min(k, kFrames - k)));
  frame.id = k;
  frame.t = after(Timestamp{1'000'000'000}, k / 30.0);
  return frame;
}

OdometryConfig loop_config(int lag_frames) {
  OdometryConfig config = visual_config(1);
  config.loop = {.enabled = true,
                 .lag_frames = lag_frames,
                 .min_translation_m = 0.05,
                 .min_gap_s = 0.3,
                 .min_votes = 5,
                 .min_inliers = 12};
  return config;
}

Corrected run_inline(const SlidingPlane& plane, const OdometryConfig& config) {
  Corrected result;
  Odometry odometry(config, plane.input().rig);
  for (int k = 0; k < kFrames; ++k) result.add(odometry.track(returning_frame(plane, k)));
  if (const auto report = odometry.finish_loops()) result.loops = report->loops;
  return result;
}

TEST(LoopWorker, AThreadGivesTheSameCorrectionsToTheBit) {
  const SlidingPlane plane(kFrames / 2 + 1);
  const Corrected expected = run_inline(plane, loop_config(10));
  ASSERT_LT(expected.first_correction(), kFrames) << "no loop was found";
  Corrected threaded;
  ThreadedOdometry odometry(loop_config(10), plane.input().rig,
                            {.on_frame = {[&](const FrameReport& report) { threaded.add(report.update); }}});
  odometry.finish_imu();
  for (int k = 0; k < kFrames; ++k) odometry.add_frame(returning_frame(plane, k));
  odometry.finish();
  threaded.loops = odometry.finish_loops()->loops;
  EXPECT_EQ(threaded.odometry, expected.odometry);
  EXPECT_EQ(threaded.corrections, expected.corrections);
  EXPECT_EQ(threaded.loops.size(), expected.loops.size());
}

TEST(LoopWorker, CorrectionsAreAppliedAfterTheLag) {
  const SlidingPlane plane(kFrames / 2 + 1);
  EXPECT_EQ(run_inline(plane, loop_config(7)).first_correction(),
            run_inline(plane, loop_config(3)).first_correction() + 4);
}

TEST(LoopWorker, CurrentFramesAreLocatedInAMapWithinASecondWithAndWithoutAThread) {
  const SlidingPlane plane(kFrames / 2 + 1);
  Odometry first(loop_config(10), plane.input().rig);
  for (int k = 0; k < kFrames; ++k) static_cast<void>(first.track(returning_frame(plane, k)));
  const LoopReport mapped = *first.finish_loops();
  constexpr int kStart = 20;  // the world of the second run begins here
  Corrected expected;
  Odometry second(loop_config(30), plane.input().rig);
  second.use_map(*mapped.map);
  for (int k = kStart; k < kFrames; ++k) expected.add(second.track(returning_frame(plane, k)));
  EXPECT_TRUE(second.finish_loops()->relocalized);
  ASSERT_LT(expected.first_correction(), 30) << "not located within one second";
  EXPECT_NEAR(expected.corrections[30].x(), SlidingPlane::camera_x_m(kStart) - SlidingPlane::camera_x_m(0),
              0.02);
  Corrected threaded;
  ThreadedOdometry odometry(loop_config(30), plane.input().rig,
                            {.on_frame = {[&](const FrameReport& report) { threaded.add(report.update); }}});
  odometry.use_map(*mapped.map);
  odometry.finish_imu();
  for (int k = kStart; k < kFrames; ++k) odometry.add_frame(returning_frame(plane, k));
  odometry.finish();
  EXPECT_EQ(threaded.corrections, expected.corrections);
  EXPECT_EQ(threaded.odometry, expected.odometry);
}

/// Image of the plane at a frame: 0 to 59, in darkness until frame 89, then 10 to 60 and back.
std::size_t interrupted_index(int k) {
  const int step = std::max(0, k - 90) % 100;
  return static_cast<std::size_t>(k < 60 ? k : 10 + std::min(step, 100 - step));
}

Frame interrupted_frame(const SlidingPlane& plane, int k) {
  Frame frame = plane.frame(interrupted_index(k));
  frame.id = k;
  frame.t = after(Timestamp{1'000'000'000}, k / 30.0);
  if (k >= 60 && k < 90) frame.gray = cv::Mat(frame.gray.size(), CV_8UC1, cv::Scalar(90));
  return frame;
}

TEST(LoopWorker, AfterALossTheViewThatComesBackIsLocatedInTheSameWorldWithAndWithoutAThread) {
  constexpr int kEnd = 180;
  const SlidingPlane plane(kFrames / 2 + 1);
  std::vector<OdometryUpdate> expected;
  Odometry odometry(loop_config(10), plane.input().rig);
  for (int k = 0; k < kEnd; ++k) expected.push_back(odometry.track(interrupted_frame(plane, k)));
  static_cast<void>(odometry.finish_loops());
  const OdometryUpdate& last = expected.back();
  ASSERT_GE(last.segment, 1) << "the odometry recovered by itself";
  ASSERT_TRUE(is_located(last.status));
  EXPECT_TRUE(last.in_map);
  const auto index = static_cast<std::int64_t>(interrupted_index(kEnd - 1));
  EXPECT_NEAR((last.T_m_w * last.T_w_c).p.x(), SlidingPlane::camera_x_m(index) - SlidingPlane::camera_x_m(0),
              0.03);
  for (const OdometryUpdate& update : expected) {
    // Not before it is located, and never with the correction of another segment.
    if (!update.in_map) {
      EXPECT_TRUE(update.T_m_w.p.isZero(0.0)) << update.frame_id;
    } else if (update.segment > 0) {
      EXPECT_LT((update.T_m_w.p - last.T_m_w.p).norm(), 0.05) << update.frame_id;
    }
  }
  std::vector<OdometryUpdate> threaded;
  ThreadedOdometry other(
      loop_config(10), plane.input().rig,
      {.on_frame = {[&](const FrameReport& report) { threaded.push_back(report.update); }}});
  other.finish_imu();
  for (int k = 0; k < kEnd; ++k) other.add_frame(interrupted_frame(plane, k));
  other.finish();
  static_cast<void>(other.finish_loops());
  ASSERT_EQ(threaded.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(threaded[k].T_m_w.p, expected[k].T_m_w.p) << k;
    EXPECT_EQ(threaded[k].in_map, expected[k].in_map) << k;
  }
}

TEST(LoopWorker, TheOdometryDoesNotDependOnLoopClosure) {
  const SlidingPlane plane(kFrames / 2 + 1);
  OdometryConfig off = loop_config(0);
  off.loop.enabled = false;
  const Corrected without = run_inline(plane, off);
  EXPECT_EQ(without.odometry, run_inline(plane, loop_config(0)).odometry);
  EXPECT_EQ(without.first_correction(), kFrames);
}

TEST(LoopWorker, AcceptedLoopsAreTrue) {
  const SlidingPlane plane(kFrames / 2 + 1);
  int accepted = 0;
  for (const LoopRecord& loop : run_inline(plane, loop_config(0)).loops) {
    if (loop.outcome != LoopOutcome::kAccepted) continue;
    const auto x_m = [](std::int64_t k) {
      return SlidingPlane::camera_x_m(std::min<std::int64_t>(k, kFrames - k));
    };
    EXPECT_NEAR(loop.T_match_query.p.x(), x_m(loop.query_frame) - x_m(loop.match_frame), 0.02);
    ++accepted;
  }
  EXPECT_GE(accepted, 3);
}

}  // namespace
}  // namespace stillpoint
