// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/covariance_file.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/geometry/so3.h"
#include "tests/support/expect_input_error.h"

namespace stillpoint::eval {
namespace {

const std::string kPoseRow = "1.0 0 0 0 0 0 0 1 ";

TEST(CovarianceFile, ReadsDiagonalsTrianglesAndMatrices) {
  const std::string upper = "1 .1 .2 0 0 0  2 .3 0 0 0  3 0 0 0  4 .4 .5  5 .6  6";
  const std::string full =
      "1 .1 .2 0 0 0  .1 2 .3 0 0 0  .2 .3 3 0 0 0  0 0 0 4 .4 .5  0 0 0 .4 5 .6  0 0 0 .5 .6 6";
  for (const std::string& numbers : {upper, full}) {
    const CovarianceTable table = find_covariances(kPoseRow + numbers + "\n", "a").value();
    ASSERT_EQ(table.rows.size(), 1U);
    EXPECT_EQ(table.rows[0].t.ns, 1'000'000'000);
    EXPECT_EQ(table.rows[0].position(0, 1), 0.1);
    EXPECT_EQ(table.rows[0].position(2, 1), 0.3);
    EXPECT_EQ(table.rows[0].rotation(0, 0), 4.0);
    EXPECT_EQ(table.rows[0].rotation(2, 0), 0.5);
    EXPECT_FALSE(table.rotation_of_body);
  }
  const CovarianceTable diagonal = parse_covariances("# t x y z\n2.5 1 2 3 4 5 6\n", "a");
  EXPECT_EQ(diagonal.rows[0].position.diagonal(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(diagonal.rows[0].rotation.diagonal(), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(diagonal.rows[0].rotation(0, 1), 0.0);
  EXPECT_EQ(parse_covariances("1403636579763555584,1,2,3,4,5,6\n", "a").rows[0].t.ns, 1403636579763555584);
}

TEST(CovarianceFile, ThoseOfOpenVinsAreOfTheRotationInTheBody) {
  const CovarianceTable table =
      find_covariances(
          "#timestamp(s) tx ty tz qx qy qz qw Pr11 Pr12\n" + kPoseRow + "4 0 0 5 0 6  1 0 0 2 0 3\n", "a")
          .value();
  EXPECT_EQ(table.rows[0].position(2, 2), 3.0);
  // The body is turned by 90 degrees about z: its x axis is the y axis of the world.
  Trajectory trajectory;
  trajectory.poses.push_back(
      {Timestamp{1'000'400'000}, Pose{exp_so3({0, 0, std::numbers::pi / 2}), Eigen::Vector3d::Zero()}});
  trajectory.poses.push_back({Timestamp{2'000'000'000}, Pose{}});
  const std::vector<StampedCovariance> rows = at_poses(trajectory, table);
  EXPECT_NEAR(rows[0].rotation(1, 1), 4.0, 1e-12);
  EXPECT_NEAR(rows[0].rotation(0, 0), 5.0, 1e-12);
  EXPECT_EQ(rows[0].position(0, 0), 1.0);
  EXPECT_TRUE(rows[1].position.isZero());
}

TEST(CovarianceFile, ColumnsOfAPoseThatBeginsLaterAreNoCovariances) {
  const std::string text =
      "secs,nsecs,x,y,z,qx,qy,qz,qw,a,b,c,d,e\n1,0,0,0,0,0,0,0,1,1,1,1,1,1\n2,0,0,0,0,0,0,0,1,1,1,1,1,1\n";
  EXPECT_FALSE(find_covariances(text, "a"));
  EXPECT_FALSE(fault_in_covariances(text + "3,0,0,0,0,0,0,0,1,-1,1,1,1,1\n", "a"));
}

TEST(CovarianceFile, OtherColumnsAreNoCovariances) {
  EXPECT_FALSE(find_covariances(kPoseRow + "\n", "a"));
  EXPECT_FALSE(find_covariances(kPoseRow + "1 2 3 4 5 6 7\n", "a"));
  EXPECT_FALSE(find_covariances(kPoseRow + "1 2 3 4 5 -6\n", "a"));  // velocities
  EXPECT_FALSE(find_covariances(kPoseRow + "1 2 3 4 5 nan\n", "a"));
  EXPECT_FALSE(find_covariances(kPoseRow + "0 0 0 0 0 0\n", "a"));
  EXPECT_FALSE(find_covariances("", "a"));
  const auto expect = [](const std::string& text, const std::string& part) {
    expect_input_error([&] { static_cast<void>(parse_covariances(text, "c.txt")); }, {"c.txt", part});
  };
  expect("1 2 3\n", "c.txt:1: has 3 fields");
  expect("1 1 1 1 1 1 1\n2 1 1 1 1 1 -1\n", "c.txt:2: is no covariance");
  expect("# nothing\n", "contains no covariances");
}

TEST(CovarianceFile, ARowWithoutCovarianceAmongOthersIsNamed) {
  const std::string good = kPoseRow + "1 2 3 4 5 6\n";
  const std::string text = "# t pose variances\n" + good + good + kPoseRow + "1 2 3 4 5 nan\n" + good;
  EXPECT_FALSE(find_covariances(text, "a"));
  const std::optional<InputError> fault = fault_in_covariances(text, "a");
  ASSERT_TRUE(fault);
  EXPECT_NE(std::string(fault->what()).find("a:4: is no covariance"), std::string::npos) << fault->what();
  // Velocities are negative in many rows.
  const std::string velocity = kPoseRow + "1 2 3 4 5 -6\n";
  EXPECT_FALSE(fault_in_covariances(good + velocity + velocity, "a"));
}

}  // namespace
}  // namespace stillpoint::eval
