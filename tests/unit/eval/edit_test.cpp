// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/edit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/expect_input_error.h"

namespace stillpoint::eval {
namespace {

/// One pose per second along x, with variances of x, y, z.
CovariantTrajectory line(int first_s, int last_s) {
  CovariantTrajectory path;
  for (int i = first_s; i <= last_s; ++i) {
    path.trajectory.poses.emplace_back(from_seconds(i), Pose{.p = {1.0 * i, 0.0, 0.0}});
    path.covariances.push_back(
        {.t = from_seconds(i), .position = Eigen::Vector3d(4.0, 1.0, 9.0).asDiagonal()});
  }
  return path;
}

TEST(Cropped, KeepsBothEndsAndTheirCovariances) {
  const CovariantTrajectory part = cropped(line(0, 9), from_seconds(2.0), from_seconds(5.0));
  ASSERT_EQ(part.trajectory.poses.size(), 4U);
  EXPECT_EQ(part.trajectory.poses.front().t, from_seconds(2.0));
  EXPECT_EQ(part.covariances.size(), 4U);
  EXPECT_EQ(part.covariances.back().t, from_seconds(5.0));
}

TEST(Merged, OrdersPartsByTime) {
  const std::vector<std::string> names{"b", "a"};
  const CovariantTrajectory all = merged({line(5, 9), line(0, 4)}, names);
  ASSERT_EQ(all.trajectory.poses.size(), 10U);
  EXPECT_EQ(all.trajectory.poses.front().t, from_seconds(0.0));
  EXPECT_EQ(all.covariances.size(), 10U);
}

TEST(Merged, DropsCovariancesThatOnePartLacks) {
  const std::vector<std::string> names{"a", "b"};
  CovariantTrajectory bare = line(5, 9);
  bare.covariances.clear();
  EXPECT_TRUE(merged({line(0, 4), bare}, names).covariances.empty());
}

TEST(Merged, RefusesPartsThatOverlap) {
  const std::vector<std::string> names{"a", "b"};
  expect_input_error(
      [&] {
        static_cast<void>(merged({line(0, 5), line(5, 9)}, names));
      },
      {"b", "overlaps in time with a", "5.000000000"});
}

TEST(InWorld, RotatesAndScalesPosesAndCovariances) {
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitZ()));
  const CovariantTrajectory moved = in_world(line(1, 1), {{quarter, {0.0, 0.0, 7.0}}, 2.0});
  EXPECT_TRUE(moved.trajectory.poses[0].T_w_f.p.isApprox(Eigen::Vector3d(0.0, 2.0, 7.0), 1e-12));
  // x and y change places, and the scale is squared.
  EXPECT_TRUE(moved.covariances[0].position.diagonal().isApprox(Eigen::Vector3d(4.0, 16.0, 36.0), 1e-12));
}

TEST(Resampled, InterpolatesWithinGapsThatAreShortEnough) {
  Trajectory path = line(0, 2).trajectory;
  path.poses.emplace_back(from_seconds(9.0), Pose{.p = {9.0, 0.0, 0.0}});
  const std::vector<Timestamp> times{from_seconds(-1.0), from_seconds(0.0), from_seconds(1.25),
                                     from_seconds(5.0),  from_seconds(9.0), from_seconds(10.0)};
  const Trajectory result = resampled(path, times, 1.0);
  ASSERT_EQ(result.poses.size(), 3U);  // 0, 1.25 and 9 s
  EXPECT_NEAR(result.poses[1].T_w_f.p.x(), 1.25, 1e-12);
  EXPECT_EQ(resampled(path, times, 10.0).poses.size(), 4U);
}

}  // namespace
}  // namespace stillpoint::eval
