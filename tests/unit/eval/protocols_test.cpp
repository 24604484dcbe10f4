// SPDX-License-Identifier: BSD-3-Clause
/// Cases in which public tools report small errors for bad runs, and the results of the strict protocols.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "eval/protocols/protocol.h"

namespace stillpoint::eval {
namespace {

constexpr double kPi = 3.14159265358979323846;

Pose on_circle(double t) {
  // 0.5 m/s on a circle with a radius of 2 m, facing forward.
  const double angle = 0.25 * t;
  const Eigen::Quaterniond q(Eigen::AngleAxisd(angle + kPi / 2, Eigen::Vector3d::UnitZ()));
  return Pose{q, {2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.1 * std::sin(t)}};
}

Trajectory circle(double begin, double end, double step) {
  Trajectory path;
  const auto count = static_cast<long>(std::llround((end - begin) / step));
  for (long i = 0; i <= count; ++i) {
    const double t = begin + step * static_cast<double>(i);
    path.poses.push_back({from_seconds(t), on_circle(t)});
  }
  return path;
}

/// Adds a drift of 0.1 m/s along x from `begin` on.
void add_drift(Trajectory& path, double begin) {
  for (StampedPose& pose : path.poses) {
    pose.T_w_f.p.x() += 0.1 * std::max(0.0, to_seconds(pose.t) - begin);
  }
}

Evaluation evaluate_with(std::string_view protocol, const Trajectory& gt, const Trajectory& est) {
  return evaluate(protocol, {gt, est, ProtocolOptions{}});
}

TEST(ZeroRpe, OnePosePer2500MsHasNoStrictRpeOverOneSecond) {
  const Trajectory gt = circle(0, 50, 0.01);
  Trajectory est = circle(0, 50, 2.5);
  add_drift(est, 0);
  // The pose closest to t + 1 s is the one at t: every pair consists of one pose.
  const Evaluation tum = evaluate_with("compat:tum", gt, est);
  EXPECT_FALSE(tum.rpe_m);
  EXPECT_FALSE(tum.rpe_deg);
  ASSERT_FALSE(tum.notes.empty());
  EXPECT_NE(tum.notes[0].find("no RPE pair of two poses"), std::string::npos);
  const Evaluation strict = evaluate_with("strict:se3", gt, est);
  EXPECT_FALSE(strict.rpe_m);
  EXPECT_EQ(strict.notes.back(), "21 of 21 RPE starts dropped: no pose at delta within the tolerance");
  EXPECT_NEAR(*strict.coverage, 0.4, 1e-9);  // 20 poses, valid for 1 s each, in 50 s
}

bool has_note(const Evaluation& evaluation, std::string_view part) {
  return std::any_of(evaluation.notes.begin(), evaluation.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

/// 20 m along a line in 40 s.
struct LineOptions {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  double noise_m = 0.0;      ///< amplitude across and along
  double noise_rad = 0.0;    ///< amplitude of the orientations
  double turns_per_s = 0.0;  ///< about the line
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  int seed = 1;
};

Trajectory line(const LineOptions& options) {
  Trajectory path;
  for (int i = 0; i <= 400; ++i) {
    const auto noise = [&](int axis) {
      return std::sin(options.seed * 17.3 * i + 31.7 * axis * axis + options.seed);
    };
    const Eigen::Vector3d position(noise(1), noise(2), noise(3));
    const Eigen::Vector3d rotation(noise(4), noise(5), noise(6));
    const Eigen::AngleAxisd turn(2.0 * kPi * options.turns_per_s * 0.1 * i, options.direction);
    const Eigen::Quaterniond wobble(
        Eigen::AngleAxisd(options.noise_rad * rotation.norm(), rotation.normalized()));
    path.poses.push_back(
        {from_seconds(0.1 * i), Pose{(turn * options.q * wobble).normalized(),
                                     0.05 * i * options.direction + options.noise_m * position}});
  }
  return path;
}

constexpr std::array<const char*, 3> kFittedProtocols{"compat:tum", "strict:se3", "strict:sim3"};

TEST(StraightLine, TheRotationAboutItIsThatOfTheOrientations) {
  for (int seed = 1; seed <= 6; ++seed) {
    for (const double noise_m : {0.0, 1e-6, 1e-3}) {
      for (const double noise_rad : {0.0, 0.01}) {
        const Trajectory gt = line({.noise_m = noise_m, .noise_rad = noise_rad, .seed = seed});
        const Trajectory est = line({.noise_m = noise_m, .noise_rad = noise_rad, .seed = seed + 10});
        for (const char* protocol : kFittedProtocols) {
          const Evaluation evaluation = evaluate_with(protocol, gt, est);
          ASSERT_TRUE(evaluation.ate_deg) << protocol << noise_m;
          EXPECT_LT(evaluation.ate_deg->rmse, 0.1 + 200.0 * noise_rad) << protocol << seed;
          EXPECT_TRUE(has_note(evaluation, "straight line")) << protocol << noise_m;
          EXPECT_TRUE(has_note(evaluation, "not determined"));
          EXPECT_LT(evaluation.ate_m->rmse, 0.003);
          EXPECT_FALSE(evaluation.alignment.determined);
        }
        EXPECT_NEAR(*evaluate_with("strict:se3", gt, est).correct_rate, 1.0, 0.01);
      }
    }
  }
}

TEST(StraightLine, AVerticalOneLeavesTheYawToTheOrientations) {
  for (int seed = 1; seed <= 6; ++seed) {
    for (const double noise_m : {0.0, 1e-3}) {
      const LineOptions up{.direction = Eigen::Vector3d::UnitZ(), .noise_m = noise_m, .noise_rad = 0.01};
      const Trajectory gt = line(up);
      Trajectory est =
          line({.direction = up.direction, .noise_m = noise_m, .noise_rad = 0.01, .seed = seed + 10});
      const Pose T_v_w{Eigen::Quaterniond(Eigen::AngleAxisd(0.4 * seed, Eigen::Vector3d::UnitZ())),
                       {1, 2, 3}};
      for (StampedPose& pose : est.poses) pose.T_w_f = T_v_w * pose.T_w_f;
      const Evaluation evaluation = evaluate_with("strict:yaw", gt, est);
      EXPECT_LT(evaluation.ate_deg->rmse, 2.0) << seed << noise_m;
      EXPECT_TRUE(has_note(evaluation, "not determined"));
    }
  }
}

void expect_no_rotation_error(const Evaluation& evaluation) {
  EXPECT_LT(evaluation.ate_m->rmse, 0.01) << evaluation.protocol;
  EXPECT_FALSE(evaluation.ate_deg || evaluation.correct_rate) << evaluation.protocol;
  EXPECT_TRUE(std::isnan(evaluation.per_pose.front().rotation_deg)) << evaluation.protocol;
  EXPECT_FALSE(evaluation.notes.empty());
}

TEST(StraightLine, TheRotationAboutItIsNotAvailableIfOrientationsDoNotDecideIt) {
  for (const double noise_m : {0.0, 1e-3}) {
    // The estimate turns about the line, the ground truth does not: each angle is as good as another.
    const Trajectory gt = line({.noise_m = noise_m, .noise_rad = 0.01});
    const Trajectory spinning = line({.noise_m = noise_m, .noise_rad = 0.01, .turns_per_s = 0.1, .seed = 11});
    // A receiver without orientations writes the identity, whatever the direction of the line.
    const Trajectory receiver = line({.direction = Eigen::Vector3d::UnitY(), .noise_m = noise_m});
    for (const char* protocol : kFittedProtocols) {
      const Evaluation spun = evaluate_with(protocol, gt, spinning);
      expect_no_rotation_error(spun);
      EXPECT_TRUE(has_note(spun, "not determined")) << protocol;
      const Evaluation received = evaluate_with(protocol, receiver, gt);
      expect_no_rotation_error(received);
      EXPECT_FALSE(received.rpe_m) << protocol;
      EXPECT_TRUE(has_note(received, "orientations of the ground truth are equal")) << protocol;
    }
  }
}

TEST(StraightLine, OfTheFirstMatchesLeavesTheRestToTheOrientations) {
  // 20 s along a line and then a curve: the rotation about the line decides the errors of the rest.
  Trajectory gt = line({.noise_m = 1e-3, .noise_rad = 0.01});
  Trajectory est = line({.noise_m = 1e-3, .noise_rad = 0.01, .seed = 11});
  for (Trajectory* path : {&gt, &est}) {
    for (StampedPose& pose : path->poses) {
      const double s = std::max(0.0, pose.T_w_f.p.x() - 10.0);
      pose.T_w_f.p += Eigen::Vector3d(0, s * s / 10.0, 0);
    }
  }
  ProtocolOptions options;
  options.align_first_n = 200;
  for (const char* protocol : kFittedProtocols) {
    const Evaluation evaluation = evaluate(protocol, {gt, est, options});
    EXPECT_LT(evaluation.ate_deg->rmse, 3.0) << protocol;
    if (!std::string_view(protocol).starts_with("compat")) {
      EXPECT_LT(evaluation.ate_m->rmse, 0.1) << protocol;
    }
  }
}

TEST(StandingPath, HasPositionErrorsWithoutAScale) {
  Trajectory gt;
  Trajectory est;
  for (int i = 0; i <= 100; ++i) {
    gt.poses.push_back({from_seconds(0.1 * i), Pose{.p = {1, 2, 3}}});
    est.poses.push_back({from_seconds(0.1 * i), Pose{.p = {0.001 * std::sin(17.3 * i), 0, 0}}});
  }
  const Evaluation evaluation = evaluate_with("strict:se3", gt, est);
  EXPECT_LT(evaluation.ate_m->rmse, 0.002);
  EXPECT_LT(evaluation.ate_deg->rmse, 0.1);
  EXPECT_TRUE(has_note(evaluation, "stand still"));
  EXPECT_THROW(static_cast<void>(evaluate_with("strict:sim3", gt, est)), std::runtime_error);
}

// As with stamps of another clock: the camera moves, but not as the ground truth at these times.
TEST(UnlikePath, IsNotCalledStanding) {
  Trajectory gt;
  Trajectory est;
  for (int i = 0; i <= 200; ++i) {
    gt.poses.push_back({from_seconds(0.1 * i), Pose{.p = {std::sin(0.2 * i), std::cos(0.31 * i), 0}}});
    est.poses.push_back({from_seconds(0.1 * i), Pose{.p = {std::sin(0.83 * i), std::cos(0.57 * i), 0}}});
  }
  const Evaluation evaluation = evaluate_with("strict:se3", gt, est);
  EXPECT_FALSE(has_note(evaluation, "stand still"));
  EXPECT_TRUE(has_note(evaluation, "do not follow those of the ground truth"));
}

TEST(MissingOrientations, MakeErrorsThatDependOnThemNotAvailable) {
  const Trajectory gt = circle(0, 50, 0.01);
  Trajectory est = circle(0, 50, 0.1);
  for (StampedPose& pose : est.poses) pose.T_w_f.q.setIdentity();
  for (const char* protocol : {"compat:tum", "strict:se3"}) {
    for (const Evaluation& evaluation :
         {evaluate_with(protocol, gt, est), evaluate_with(protocol, est, gt)}) {
      EXPECT_LT(evaluation.ate_m->rmse, 0.01);
      EXPECT_FALSE(evaluation.ate_deg || evaluation.rpe_m || evaluation.rpe_deg || evaluation.correct_rate);
      EXPECT_TRUE(has_note(evaluation, "orientations of the"));
    }
  }
}

TEST(SlowGroundTruth, IsInterpolatedByTheStrictProtocolsIfAskedTo) {
  const Trajectory gt = circle(0, 60, 1.0);
  const Trajectory est = circle(0.037, 59.9, 0.1);
  const Evaluation none = evaluate_with("strict:se3", gt, est);
  EXPECT_EQ(none.pairs, 0U);
  EXPECT_TRUE(has_note(none, "one pose per 1 s; --max-difference 1.1"));
  ProtocolOptions options;
  options.max_difference_s = 1.1;
  const Evaluation evaluation = evaluate("strict:se3", {gt, est, options});
  EXPECT_GT(evaluation.pairs, 590U);
  EXPECT_LT(evaluation.ate_m->rmse, 0.05);
  EXPECT_TRUE(has_note(evaluation, "interpolated over 1 s"));
}

TEST(SlowGroundTruth, IsNotedWhereTheRpeOfTheToolTakesTheClosestPose) {
  const Trajectory gt = circle(0, 60, 1.0);
  EXPECT_TRUE(
      has_note(evaluate_with("compat:tum", gt, circle(0.037, 59.9, 0.1)),
               "the ground truth has one pose per 1 s: RPE compares poses with one up to 0.5 s away"));
  EXPECT_FALSE(has_note(evaluate_with("compat:tum", gt, circle(0.0, 59.0, 1.0)), "RPE compares"));
  EXPECT_FALSE(
      has_note(evaluate_with("compat:tum", circle(0, 60, 0.1), circle(0.037, 59.9, 0.1)), "RPE compares"));
}

TEST(OnePose, HasNoErrorsAndIsNotCorrect) {
  const Trajectory gt = circle(0, 50, 0.01);
  const Trajectory one = circle(0, 0, 0.1);
  ASSERT_EQ(one.poses.size(), 1U);
  for (const Protocol& protocol : protocols()) {
    const Evaluation evaluation = evaluate_with(protocol.name, gt, one);
    EXPECT_FALSE(evaluation.ate_m || evaluation.ate_deg || evaluation.rpe_m) << protocol.name;
    EXPECT_TRUE(evaluation.per_pose.empty()) << protocol.name;
    EXPECT_TRUE(has_note(evaluation, "failed: the estimate has one pose")) << protocol.name;
    if (protocol.name.starts_with("strict")) {
      EXPECT_EQ(evaluation.correct_rate, 0.0) << protocol.name;
    }
  }
}

TEST(FewPairs, AreNoted) {
  const Trajectory gt = circle(0, 50, 0.01);
  const Evaluation evaluation = evaluate_with("strict:se3", gt, circle(0, 50, 10.0));
  EXPECT_TRUE(has_note(evaluation, "only 6 poses were compared"));
  EXPECT_TRUE(has_note(evaluate_with("strict:se3", gt, circle(0, 1.2, 0.1)), "only"));
  const Evaluation sparse = evaluate_with("compat:tum", gt, circle(0, 3.0, 0.6));
  EXPECT_EQ(sparse.rpe_pairs, sparse.rpe_m->count);
  EXPECT_TRUE(has_note(sparse, "the RPE is that of only"));
}

TEST(RpeAcrossAGap, IsNotPartOfTheStrictRpe) {
  // Exact, except for a jump of 1 m during a gap from 20 to 25 s.
  const Trajectory gt = circle(0, 50, 0.01);
  Trajectory est = circle(0, 20, 0.1);
  Trajectory after_gap = circle(25, 50, 0.1);
  for (StampedPose& pose : after_gap.poses) pose.T_w_f.p.x() += 1.0;
  est.poses.insert(est.poses.end(), after_gap.poses.begin(), after_gap.poses.end());
  // Starts at 19.1 .. 19.9 s are paired with 20.0 s, less than 1 s later; 20.0 s is paired with itself. No
  // pair crosses the gap, but these shorter pairs lower the mean.
  const Evaluation tum = evaluate_with("compat:tum", gt, est);
  EXPECT_NEAR(tum.rpe_m->rmse, 0.0, 1e-9);
  const Evaluation strict = evaluate_with("strict:se3", gt, est);
  EXPECT_NEAR(strict.rpe_m->rmse, 0.0, 1e-9);
  EXPECT_EQ(tum.rpe_m->count - strict.rpe_m->count, 9u);  // 10 around the gap; TUM drops one at the end
  EXPECT_NEAR(*strict.coverage, 1.0 - 4.0 / 50.0, 1e-9);  // no valid pose from 21 to 25 s
  EXPECT_GT(strict.ate_m->rmse, 0.1);                     // the jump affects the ATE
  ASSERT_EQ(strict.lost.size(), 1u);
  EXPECT_NEAR(to_seconds(strict.lost[0].begin), 21.0, 1e-9);
}

TEST(LostTracking, ARunThatEndsEarlyHasASmallErrorAndASmallCoverage) {
  const Trajectory gt = circle(0, 50, 0.01);
  Trajectory whole = circle(0, 50, 0.1);
  add_drift(whole, 5.0);
  Trajectory lost = circle(0, 5, 0.1);
  // By its ATE alone the lost run would be the better one.
  EXPECT_LT(evaluate_with("compat:tum", gt, lost).ate_m->rmse,
            0.01 * evaluate_with("compat:tum", gt, whole).ate_m->rmse);
  EXPECT_NEAR(*evaluate_with("strict:se3", gt, lost).coverage, 6.0 / 50.0,
              1e-9);  // 5 s, and 1 s validity of the last pose
  EXPECT_NEAR(*evaluate_with("strict:se3", gt, whole).coverage, 1.0, 1e-9);
}

TEST(YawAlignment, LevelsAWorldWhoseTiltIsKnown) {
  const Trajectory gt = circle(0, 50, 0.1);
  // The world of the estimate is tilted by 3 degrees about x; gravity tells by which rotation.
  const Pose T_w_v{Eigen::Quaterniond(Eigen::AngleAxisd(0.052, Eigen::Vector3d::UnitX())),
                   Eigen::Vector3d::Zero()};
  Trajectory est = gt;
  for (StampedPose& pose : est.poses) pose.T_w_f = T_w_v.inverse() * pose.T_w_f;
  ProtocolOptions options;
  EXPECT_GT(evaluate("strict:yaw", {gt, est, options}).ate_m->rmse, 0.05);
  options.q_level_w = T_w_v.q;
  const Evaluation leveled = evaluate("strict:yaw", {gt, est, options});
  EXPECT_LT(leveled.ate_m->rmse, 1e-9);
  EXPECT_LT(leveled.alignment.S_w_v.T_w_v.q.angularDistance(T_w_v.q), 1e-9);  // for drawings
  EXPECT_EQ(leveled.notes.back(), "the world was leveled by the estimated gravity, by 2.979 deg");
  // Other alignments contain the tilt.
  EXPECT_EQ(evaluate("strict:se3", {gt, est, options}).notes, evaluate("strict:se3", {gt, est, {}}).notes);
}

TEST(Protocols, HaveADescriptionAndAVersion) {
  for (const Protocol& protocol : protocols()) {
    EXPECT_GT(protocol.text.size(), 100u) << protocol.name;
    EXPECT_GE(protocol.version, 1) << protocol.name;
  }
  EXPECT_THROW(static_cast<void>(evaluate_with("compat:none", {}, {})), std::runtime_error);
}

TEST(Protocols, HaveNoErrorsForEmptyInput) {
  for (const Protocol& protocol : protocols()) {
    const Evaluation empty = evaluate_with(protocol.name, circle(0, 1, 0.1), {});
    EXPECT_FALSE(empty.ate_m) << protocol.name;
    EXPECT_FALSE(empty.rpe_m) << protocol.name;
    const Evaluation without_gt = evaluate_with(protocol.name, {}, circle(0, 1, 0.1));
    EXPECT_FALSE(without_gt.ate_m) << protocol.name;
    EXPECT_FALSE(without_gt.coverage) << protocol.name;
  }
}

}  // namespace
}  // namespace stillpoint::eval
