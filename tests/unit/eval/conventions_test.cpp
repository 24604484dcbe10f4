// SPDX-License-Identifier: BSD-3-Clause
#include "eval/compare/conventions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "eval/compare/time_offset.h"
#include "eval/trajectory/alignment.h"
#include "tests/support/random.h"
#include "tests/support/simulated/smooth_path.h"

namespace stillpoint::eval {
namespace {

std::vector<Convention> violations(const Trajectory& gt, const Trajectory& est) {
  std::vector<Convention> found;
  for (const ConventionFinding& finding : find_convention_violations(gt, est)) {
    EXPECT_FALSE(finding.message.empty());
    found.push_back(finding.convention);
  }
  return found;
}

const Trajectory kGt = test::smooth_path(2000, 0.01);
const Trajectory kEst = test::smooth_path(580, 1.0 / 30.0, 0.2);

TEST(Conventions, AcceptACorrectEstimate) { EXPECT_TRUE(violations(kGt, kEst).empty()); }

TEST(Conventions, AcceptAnEstimateInAnotherWorldFrame) {
  Trajectory est = kEst;
  const Pose T_v_w{exp_so3({0.5, -1.0, 2.0}), {10, 20, 30}};
  for (StampedPose& pose : est.poses) pose.T_w_f = T_v_w * pose.T_w_f;
  EXPECT_TRUE(violations(kGt, est).empty());
}

TEST(Conventions, DetectMillisecondsInBothFiles) {
  Trajectory gt = kGt;
  for (StampedPose& pose : gt.poses) pose.t.ns *= 1000;  // one pose per 10 ms, read as 10 s
  EXPECT_EQ(violations(gt, gt), std::vector{Convention::kStampUnit});
  for (StampedPose& pose : gt.poses) pose.t.ns += 417'000'000;  // with decimals
  EXPECT_EQ(violations(gt, gt), std::vector{Convention::kStampUnit});
}

TEST(Conventions, DetectFrameNumbersAsStamps) {
  const auto numbered = [](std::int64_t first, std::int64_t step) {
    Trajectory path = test::smooth_path(200, 0.05);
    for (std::size_t i = 0; i < path.poses.size(); ++i)
      path.poses[i].t.ns = (first + step * static_cast<std::int64_t>(i)) * 1'000'000'000;
    return path;
  };
  EXPECT_EQ(violations(numbered(0, 1), numbered(0, 1)), std::vector{Convention::kStampUnit});
  EXPECT_EQ(violations(numbered(0, 3), numbered(0, 3)), std::vector{Convention::kStampUnit});
  // a GNSS receiver at 1 Hz
  EXPECT_TRUE(violations(numbered(1'700'000'000, 1), numbered(1'700'000'000, 1)).empty());
}

TEST(Conventions, DetectASwappedQuaternionOrder) {
  Trajectory est = kEst;
  for (StampedPose& pose : est.poses) {
    const Eigen::Quaterniond q = pose.T_w_f.q;  // written as w x y z, read as x y z w
    pose.T_w_f.q = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y());
  }
  EXPECT_EQ(violations(kGt, est), std::vector{Convention::kQuaternionOrder});
}

TEST(QuaternionOrder, IsFoundWhicheverFileIsInAnotherOrder) {
  const auto file = [](const Trajectory& trajectory, bool wrong) {
    return LoadedTrajectory{
        .trajectory = wrong ? with_other_order(trajectory, QuaternionOrder::kWxyz) : trajectory,
        .repairs = {},
        .order = QuaternionOrder::kXyzw,
        .order_source = OrderSource::kFormat};
  };
  Trajectory noisy = kEst;  // 0.2 deg in turns, in a world of its own
  const Pose T_v_w{exp_so3({0.5, -1.0, 2.0}), {10, 20, 30}};
  for (std::size_t i = 0; i < noisy.poses.size(); ++i) {
    const double angle = 0.0035 * std::sin(static_cast<double>(i));
    noisy.poses[i].T_w_f = T_v_w * noisy.poses[i].T_w_f;
    noisy.poses[i].T_w_f.q = noisy.poses[i].T_w_f.q * exp_so3({angle, -angle, angle});
  }
  EXPECT_FALSE(find_quaternion_order(file(kGt, false), file(noisy, false)));
  for (const auto& [gt, est] : {std::pair(true, false), {false, true}, {true, true}}) {
    const auto found = find_quaternion_order(file(kGt, gt), file(noisy, est));
    ASSERT_TRUE(found) << gt << est;
    EXPECT_EQ(found->gt, gt);
    EXPECT_EQ(found->est, est);
    EXPECT_LT(found->corrected_rpe_deg_per_s, 1.0);
  }
}

TEST(QuaternionOrder, IsNotConfusedWithAnotherBodyFrame) {
  for (const Eigen::Vector3d& rotation :
       {Eigen::Vector3d(0.0, 1.57, 0.0), Eigen::Vector3d(1.2, -1.2, 1.2), Eigen::Vector3d(0.0, 0.0, 3.1)}) {
    const LoadedTrajectory gt{.trajectory = kGt, .repairs = {}, .order_source = OrderSource::kFormat};
    const LoadedTrajectory est{
        .trajectory = move_to_frame(kEst, Pose{exp_so3(rotation), {0.02, 0.01, 0}}, "c"),
        .repairs = {},
        .order_source = OrderSource::kFormat};
    EXPECT_FALSE(find_quaternion_order(gt, est)) << rotation.transpose();
  }
}

TEST(QuaternionOrder, IsNotAskedOfFilesWithoutColumnsOfQuaternions) {
  const LoadedTrajectory bag{.trajectory = with_other_order(kGt, QuaternionOrder::kWxyz), .repairs = {}};
  EXPECT_FALSE(find_quaternion_order(bag, bag));
}

TEST(Conventions, DetectInvertedPoses) {
  Trajectory est = kEst;
  for (StampedPose& pose : est.poses) pose.T_w_f = pose.T_w_f.inverse();
  EXPECT_EQ(violations(kGt, est), std::vector{Convention::kInvertedPoses});
}

TEST(Conventions, DetectInvertedRotationsBesideRightPositions) {
  Trajectory est = kEst;
  for (StampedPose& pose : est.poses) pose.T_w_f.q = pose.T_w_f.q.conjugate();
  EXPECT_EQ(violations(kGt, est), std::vector{Convention::kInvertedPoses});
}

TEST(Conventions, DetectAnotherBodyFrame) {
  const Pose T_b_c{exp_so3({0.0, 1.57, 0.0}), {0.02, 0.01, 0.0}};
  EXPECT_EQ(violations(kGt, move_to_frame(kEst, T_b_c, "camera")), std::vector{Convention::kBodyFrame});
}

TEST(Conventions, ExplainASmallRotationByTheErrorsOfThePositions) {
  const auto with_errors = [](double error_m) {
    Trajectory gt, est;
    for (int i = 0; i < 60; ++i) {
      const double t = 0.1 * i;
      const Eigen::Vector3d p{0.2 * std::sin(t), 0.2 * std::cos(2.0 * t), 0.1 * std::sin(3.0 * t)};
      const Eigen::Vector3d error{0.0, 0.0, i % 2 == 0 ? error_m : -error_m};
      const Eigen::Quaterniond q = exp_so3({0.02 * std::sin(t), 0.0, 0.0});
      gt.poses.push_back({from_seconds(t), {q, p}});
      est.poses.push_back({from_seconds(t), {q, exp_so3({0.0, 0.0, 0.1}) * p + error}});
    }
    return violations(gt, est);
  };
  EXPECT_EQ(with_errors(0.001), std::vector{Convention::kBodyFrame});
  EXPECT_TRUE(with_errors(0.05).empty());
}

TEST(Conventions, DetectAConstantTimeOffset) {
  Trajectory est = kEst;
  for (StampedPose& pose : est.poses) pose.t = after(pose.t, 0.08);
  EXPECT_EQ(violations(kGt, est), std::vector{Convention::kTimeOffset});
}

TEST(Conventions, DetectStampsInAnotherUnit) {
  Trajectory est = kEst;
  for (StampedPose& pose : est.poses) pose.t.ns *= 1'000'000;  // microseconds read as seconds
  const std::vector<ConventionFinding> found = find_convention_violations(kGt, est);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].convention, Convention::kStampUnit);
  EXPECT_NE(found[0].message.find("microseconds"), std::string::npos);
}

TEST(Conventions, DetectAnotherEpoch) {
  Trajectory est = kEst;
  for (StampedPose& pose : est.poses) pose.t = after(pose.t, 1.5e9);
  EXPECT_EQ(violations(kGt, est), std::vector{Convention::kStampUnit});
}

TEST(Conventions, DetectSwappedArguments) {
  Trajectory est = kEst;  // starts at the identity, like the output of an odometry
  const Pose T_v_w = kEst.poses.front().T_w_f.inverse();
  for (StampedPose& pose : est.poses) pose.T_w_f = T_v_w * pose.T_w_f;
  EXPECT_EQ(violations(est, kGt), std::vector{Convention::kSwappedArguments});
  EXPECT_TRUE(violations(kGt, est).empty());
}

TEST(Conventions, DetectAnEstimateThatSurroundsAndOutpacesTheGroundTruth) {
  EXPECT_EQ(violations(test::smooth_path(180, 0.1, 1.0), kGt), std::vector{Convention::kSwappedArguments});
}

TEST(Conventions, DetectAScaleAndDoNotCallItAnOffset) {
  for (const double scale : {0.2, 5.0}) {
    Trajectory est = kEst;
    for (StampedPose& pose : est.poses) pose.T_w_f.p *= scale;
    EXPECT_EQ(violations(kGt, est), std::vector{Convention::kScale}) << scale;
  }
}

TEST(Conventions, CallNoJumpAScale) {
  Trajectory est = kEst;
  for (std::size_t i = est.poses.size() / 2; i < est.poses.size(); ++i) est.poses[i].T_w_f.p.x() += 50.0;
  EXPECT_TRUE(violations(kGt, est).empty());
}

TEST(Conventions, CallNoNoiseAScale) {
  Trajectory gt = kGt;  // standing, up to 1 %
  Trajectory est = kEst;
  for (StampedPose& pose : gt.poses) pose.T_w_f.p *= 1e-3;
  Random random(1);
  for (StampedPose& pose : est.poses) pose.T_w_f.p = 1e-3 * pose.T_w_f.p + 0.02 * random.normal3();
  EXPECT_TRUE(violations(gt, est).empty());
}

TEST(Conventions, DetectATimeOffsetOnACircleByTheOrientations) {
  const auto circle = [](double shift_s) {
    Trajectory path;
    for (int i = 0; i < 1000; ++i) {
      const double t = 0.03 * i + shift_s;
      const double angle = 0.5 * t;  // 0.3 s are 8.6 deg
      path.poses.push_back({from_seconds(0.03 * i),
                            {exp_so3({0.0, 0.1 * std::sin(0.7 * t), 0.0}),
                             {2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.0}}});
    }
    return path;
  };
  const std::vector<ConventionFinding> found = find_convention_violations(circle(0.0), circle(0.3));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].convention, Convention::kTimeOffset);
  EXPECT_NE(found[0].message.find("0.30 s"), std::string::npos) << found[0].message;
}

TEST(Conventions, DetectAMirroredEstimate) {
  Trajectory est = kEst;
  for (StampedPose& pose : est.poses) pose.T_w_f.p.y() *= -1.0;
  const std::vector<Convention> found = violations(kGt, est);
  EXPECT_NE(std::find(found.begin(), found.end(), Convention::kMirrored), found.end());
}

TEST(Conventions, TellTheScaleOfAMirroredEstimate) {
  Trajectory est = kEst;  // centimeters and y to the right, as of Unreal
  for (StampedPose& pose : est.poses)
    pose.T_w_f.p = 100.0 * pose.T_w_f.p.cwiseProduct(Eigen::Vector3d(1, -1, 1));
  const std::vector<ConventionFinding> found = find_convention_violations(kGt, est);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].convention, Convention::kMirrored);
  EXPECT_NE(found[0].message.find("scaled by 0.01,"), std::string::npos) << found[0].message;
}

TEST(TimeOffset, IsFoundFarAway) {
  for (const double shift : {-1500000000.0, -18.0, -3.4, 0.0, 0.5, 7.9, 37.0}) {
    Trajectory est = test::smooth_path(1200, 1.0 / 30.0, 3.0);
    for (StampedPose& pose : est.poses) pose.t = after(pose.t, -shift);
    const auto found = find_time_offset(test::smooth_path(5000, 0.01), est);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->undetermined, "") << shift;
    EXPECT_NEAR(found->offset_s, shift, 1e-3);
  }
}

// Over the step of the grid, 0.05 s, white noise of 2 cm is a speed of 1 m/s.
TEST(TimeOffset, IsFoundForPositionsWithNoise) {
  const auto with_noise = [](Trajectory path, double sigma_m) {
    Random random(7);
    for (StampedPose& pose : path.poses) {
      pose.T_w_f.q = Eigen::Quaterniond::Identity();
      pose.T_w_f.p += sigma_m * random.normal3();
    }
    return path;
  };
  const Trajectory gt = with_noise(test::smooth_path(3000, 0.01), 0.0);
  for (const double shift : {-0.5, 0.5, 4.0}) {
    Trajectory est = with_noise(test::smooth_path(780, 1.0 / 30.0, 2.0), 0.02);
    for (StampedPose& pose : est.poses) pose.t = after(pose.t, -shift);
    const auto found = find_time_offset(gt, est);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->undetermined, "") << shift;
    EXPECT_NEAR(found->offset_s, shift, 0.02);
  }
}

TEST(TimeOffset, OfAScaledEstimateIsThatOfItsStamps) {
  Trajectory est = kEst;
  for (StampedPose& pose : est.poses) {
    pose.T_w_f.p *= 0.2;
    pose.t = after(pose.t, -0.31);
  }
  EXPECT_NEAR(find_time_offset(kGt, est)->offset_s, 0.31, 1e-3);
}

TEST(TimeOffset, IsNotDeterminedByMotionThatDoesNotTellIt) {
  const auto path = [](double rate) {
    Trajectory line;
    for (int i = 0; i < 400; ++i) {
      const double t = 0.05 * i;
      line.poses.push_back({from_seconds(t), Pose{Eigen::Quaterniond::Identity(), {rate * t, 0, 0}}});
    }
    return line;
  };
  EXPECT_NE(find_time_offset(path(0.5), path(0.5))->undetermined, "");  // constant speed
  EXPECT_NE(find_time_offset(path(0.0), path(0.0))->undetermined, "");  // standing
  Trajectory other;                                                     // another motion
  for (int i = 0; i < 400; ++i) {
    const double t = 0.05 * i;
    other.poses.push_back({from_seconds(t), Pose{exp_so3({0.0, 0.0, std::sin(5.3 * t * t * 0.1)}),
                                                 {std::sin(3.1 * t), std::sin(1.9 * t * t * 0.2), 0}}});
  }
  EXPECT_NE(find_time_offset(kGt, other)->undetermined, "");
  Trajectory circle;  // three equal rounds with a varying speed
  for (int i = 0; i < 600; ++i) {
    const double t = 0.05 * i;
    const double angle = 2.0 * M_PI * t / 10.0 + 0.5 * std::sin(2.0 * M_PI * t / 10.0);
    circle.poses.push_back(
        {from_seconds(t), Pose{exp_so3({0, 0, angle}), {std::cos(angle), 1.5 * std::sin(angle), 0}}});
  }
  EXPECT_NE(find_time_offset(circle, circle)->undetermined, "");
}

TEST(Conventions, DetectAPoseThatIsRepeatedWhileTheBodyMoves) {
  Trajectory est = kEst;
  for (std::size_t i = 200; i < 290; ++i) est.poses[i].T_w_f = est.poses[199].T_w_f;
  EXPECT_EQ(violations(kGt, est), std::vector{Convention::kRepeatedPoses});
  const std::string message = find_convention_violations(kGt, est).front().message;
  EXPECT_NE(message.find("for 3.0 of 19.3 s"), std::string::npos) << message;
  EXPECT_NE(message.find("6.6 s after its start"), std::string::npos) << message;
}

TEST(Conventions, AcceptEqualPosesOfABodyThatRests) {
  Trajectory gt = kGt;
  Trajectory est = kEst;
  for (StampedPose& pose : gt.poses) {
    if (pose.t.ns > gt.poses[900].t.ns) pose.T_w_f = gt.poses[900].T_w_f;
  }
  for (StampedPose& pose : est.poses) {
    if (pose.t.ns > gt.poses[900].t.ns) pose.T_w_f = gt.poses[900].T_w_f;
  }
  EXPECT_TRUE(violations(gt, est).empty());
}

}  // namespace
}  // namespace stillpoint::eval
