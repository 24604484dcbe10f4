// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/imu_file.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

std::vector<VectorSample> samples_ms(std::initializer_list<std::pair<std::int64_t, double>> values) {
  std::vector<VectorSample> samples;
  for (const auto& [t, x] : values) {
    samples.push_back(VectorSample{.t = Timestamp{t * 1'000'000}, .value = Eigen::Vector3d(x, 2 * x, 3 * x)});
  }
  return samples;
}

TEST(MergeOntoGyro, InterpolatesLinearlyAndDropsSamplesOutsideTheTimeSpan) {
  const auto gyro = samples_ms({{0, 1}, {5, 2}, {10, 3}, {11, 4}, {20, 5}, {21, 6}});
  const auto accel = samples_ms({{1, 0}, {9, 8}, {11, 20}, {20, 2}});
  const std::vector<ImuSample> merged = merge_onto_gyro(gyro, accel);
  ASSERT_EQ(merged.size(), 4U);                                          // 0 and 21 ms lie outside 1 to 20 ms
  EXPECT_TRUE(merged[0].accel_b.isApprox(Eigen::Vector3d(4, 8, 12)));    // halfway from 0 to 8
  EXPECT_TRUE(merged[1].accel_b.isApprox(Eigen::Vector3d(14, 28, 42)));  // halfway from 8 to 20
  EXPECT_TRUE(merged[2].accel_b.isApprox(Eigen::Vector3d(20, 40, 60)));  // on a sample
  EXPECT_TRUE(merged[3].accel_b.isApprox(Eigen::Vector3d(2, 4, 6)));     // on the last
  EXPECT_EQ(merged[3].gyro_b, Eigen::Vector3d(5, 10, 15));
  EXPECT_TRUE(merge_onto_gyro(gyro, {}).empty());
}

TEST(MergeOntoGyro, DropsSamplesWithinAGapOfTheAccelerometer) {
  const auto gyro = samples_ms({{0, 1}, {100, 2}, {500, 3}, {1000, 4}, {1040, 5}});
  const auto accel = samples_ms({{0, 0}, {50, 1}, {1000, 2}, {1050, 3}});
  const std::vector<ImuSample> merged = merge_onto_gyro(gyro, accel);
  ASSERT_EQ(merged.size(), 3U);  // 100 and 500 ms lie between 50 and 1000 ms
  EXPECT_EQ(merged[0].t, Timestamp{0});
  EXPECT_EQ(merged[1].t, Timestamp{1'000'000'000});
  EXPECT_TRUE(merged[2].accel_b.isApprox(Eigen::Vector3d(2.8, 5.6, 8.4)));
}

TEST(ImuFile, FaultyRowErrorsNameTheLine) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    return [&folder, text] {
      FaultLog strict;
      static_cast<void>(read_imu_file(folder.write("imu.csv", text), eval::TimeUnit::kNanoseconds, strict));
    };
  };
  expect_input_error(read("#t\n"), {"imu.csv", "contains no samples"});
  expect_input_error(read("2,0,0,0,0,0,9\n1,0,0,0,0,0,9\n"), {"imu.csv:2", "sort the file"});
  expect_input_error(read("2,0,0,0,0,0,9\n2,0,0,0,0,0,9\n"), {"imu.csv:2", "repeats"});
  expect_input_error(read("2,0,nan,0,0,0,9\n"), {"imu.csv:1", "not finite"});
  expect_input_error(read("2,0,1e30,0,0,0,9\n"),
                     {"imu.csv:1", "angular velocity 1e+30 exceeds 100 rad/s", "deg/s"});
  expect_input_error(read("2,0,0,0,0,0,-1001\n"),
                     {"imu.csv:1", "acceleration -1001 exceeds 1000 m/s^2", "mg"});
  expect_input_error(read("2,0,0,0,0,0\n"), {"imu.csv:1", "6 field(s)"});
  expect_input_error(read("2.5,0,0,0,0,0,9\n"), {"imu.csv:1", "integer number of nanoseconds"});
}

TEST(ImuFile, AnEmptyFieldIsAnErrorAndDoesNotMoveTheOthers) {
  const TemporaryFolder folder;
  FaultLog faults(FaultLog::Mode::kCollect);
  const auto samples = read_imu_file(
      folder.write("imu.csv",
                   "#timestamp [ns],wx,wy,wz,ax,ay,az,temperature\n1,1,2,3,4,5,6,31\n2,1,2,,4,5,6,31\n"
                   "3,1,2,3,4,5,6,\n4,,,,,,,\n"),
      eval::TimeUnit::kNanoseconds, faults);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[1].t, Timestamp{3});
  ASSERT_EQ(faults.messages().size(), 2U);
  EXPECT_NE(faults.messages()[0].find("imu.csv:3: field 4 is empty"), std::string::npos);
}

TEST(ImuFile, ReadsTheColumnsThatTheHeaderNames) {
  const TemporaryFolder folder;
  for (const std::string text :
       {"#timestamp [ns],a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2],w_RS_S_x [rad s^-1],w_RS_S_y "
        "[rad "
        "s^-1],w_RS_S_z [rad s^-1]\n5,4,5,6,1,2,3\n",
        "temperature,time_ns,gyro_x,gyro_y,gyro_z,acc_x,acc_y,acc_z\n31,5,1,2,3,4,5,6\n",
        "t (ns),angular_velocity.x,angular_velocity.y,angular_velocity.z,linear_acceleration.x,"
        "linear_acceleration.y,linear_acceleration.z,mag.x,mag.y,mag.z\n5,1,2,3,4,5,6,7,8,9\n"}) {
    FaultLog strict;
    const auto samples = read_imu_file(folder.write("imu.csv", text), eval::TimeUnit::kNanoseconds, strict);
    ASSERT_EQ(samples.size(), 1U) << text;
    EXPECT_EQ(samples[0].t, Timestamp{5});
    EXPECT_EQ(samples[0].gyro_b, Eigen::Vector3d(1, 2, 3)) << text;
    EXPECT_EQ(samples[0].accel_b, Eigen::Vector3d(4, 5, 6)) << text;
  }
}

TEST(ImuFile, JoinsSecondsAndNanosecondsOfTwoColumns) {
  const TemporaryFolder folder;
  FaultLog strict;
  const auto samples = read_imu_file(
      folder.write("imu.csv",
                   "header.stamp.secs,header.stamp.nsecs,angular_velocity.x,angular_velocity.y,"
                   "angular_velocity.z,linear_acceleration.x,linear_acceleration.y,linear_acceleration.z\n"
                   "7,5,1,2,3,4,5,6\n"),
      eval::TimeUnit::kNanoseconds, strict);
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].t, Timestamp{7'000'000'005});
  EXPECT_EQ(samples[0].gyro_b, Eigen::Vector3d(1, 2, 3));
}

TEST(ImuFile, AHeaderWithOtherUnitsOrColumnsIsAnError) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& header) {
    return [&folder, header] {
      FaultLog strict;
      const auto file = folder.write("imu.csv", header + "\n5,1,2,3,4,5,6\n");
      static_cast<void>(read_imu_file(file, eval::TimeUnit::kNanoseconds, strict));
    };
  };
  expect_input_error(read("#t,wx [deg/s],wy,wz,ax,ay,az"), {"imu.csv:1", "deg/s", "rad/s"});
  expect_input_error(read("#t,wx [\u00b0/s],wy,wz,ax,ay,az"), {"imu.csv:1", "unit \u00b0/s", "rad/s"});
  expect_input_error(read("#t,wx,wy,wz,ax [g],ay [g],az [g]"), {"imu.csv:1", "unit g", "m/s^2"});
  expect_input_error(read("time,a,b,c,d,e,f"), {"imu.csv:1", "the header does not name"});
  expect_input_error(read("t (us),wx,wy,wz,ax,ay,az"), {"imu.csv:1", "us"});
}

TEST(ImuFile, ACollectingLogSkipsFaultyRowsOnly) {
  const TemporaryFolder folder;
  FaultLog faults(FaultLog::Mode::kCollect);
  const auto samples =
      read_imu_file(folder.write("imu.csv", "1,0,0,0,0,0,9\n3,0,0,0,0,0,inf\n2,0,0,0,0,0,9\n"),
                    eval::TimeUnit::kNanoseconds, faults);
  EXPECT_EQ(samples.size(), 2U);
  EXPECT_EQ(faults.messages().size(), 1U);
}

}  // namespace
}  // namespace stillpoint::datasets
