// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/nmea_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "eval/io/trajectory_file.h"
#include "tests/support/expect_input_error.h"

namespace stillpoint::eval {
namespace {

const std::string kDate = "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A\r\n";
const std::string kFirst = "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n";

TEST(NmeaFile, GivesTheFirstPositionTheOriginAndItsUtcTime) {
  const LoadedTrajectory loaded = parse_nmea(kDate + kFirst, "f");
  ASSERT_EQ(loaded.trajectory.poses.size(), 1U);
  EXPECT_EQ(loaded.trajectory.frame, kGnssFrame);
  EXPECT_EQ(loaded.trajectory.poses[0].t.ns, 764426119'000'000'000);  // date -u -d "1994-03-23 12:35:19" +%s
  EXPECT_LT(loaded.trajectory.poses[0].T_w_f.p.norm(), 1e-9);
}

TEST(NmeaFile, PlacesPositionsInTheTangentPlane) {
  // 0.1 minutes to the north, 0.1 minutes to the east, 2 m up, one second later.
  const LoadedTrajectory loaded =
      parse_nmea(kDate + kFirst + "$GPGGA,123520,4807.138,N,01131.100,E,1,08,0.9,547.4,M,46.9,M,,\n", "f");
  ASSERT_EQ(loaded.trajectory.poses.size(), 2U);
  // Radii of curvature at 48.1173 degrees: N = a / w, M = a (1 - e^2) / w^3, w = sqrt(1 - e^2
  // sin^2(latitude)).
  const double latitude = (48.0 + 7.038 / 60.0) * std::numbers::pi / 180.0;
  const double e2 = 0.00669437999014;
  const double w = std::sqrt(1.0 - e2 * std::sin(latitude) * std::sin(latitude));
  const double height = 545.4 + 46.9;
  const double angle = 0.1 / 60.0 * std::numbers::pi / 180.0;
  const double north = angle * (6378137.0 * (1.0 - e2) / (w * w * w) + height);
  const double east = angle * (6378137.0 / w + height) * std::cos(latitude);
  const Eigen::Vector3d& p = loaded.trajectory.poses[1].T_w_f.p;
  EXPECT_NEAR(p.x(), east, 0.01);
  EXPECT_NEAR(p.y(), north, 0.01);
  EXPECT_NEAR(p.z(), 2.0, 0.01);
  EXPECT_EQ(loaded.trajectory.poses[1].t.ns - loaded.trajectory.poses[0].t.ns, 1'000'000'000);
}

TEST(NmeaFile, SkipsDamagedSentencesAndPositionsWithoutFix) {
  const std::string damaged = "$GPGGA,123520,4807.138,N,01131.100,E,1,08,0.9,547.4,M,46.9,M,,*00\n";
  const std::string without_fix = "$GPGGA,123521,,,,,0,00,,,M,,M,,\n";
  const LoadedTrajectory loaded = parse_nmea(kFirst + damaged + without_fix + kDate, "f");
  EXPECT_EQ(loaded.trajectory.poses.size(), 1U);
  EXPECT_EQ(loaded.repairs.skipped, 2U);
}

TEST(NmeaFile, ContinuesAfterMidnight) {
  const std::string before = "$GPGGA,235959,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,\n";
  const std::string after = "$GPGGA,000001,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,\n";
  const LoadedTrajectory loaded = parse_nmea(kDate + before + after, "f");
  ASSERT_EQ(loaded.trajectory.poses.size(), 2U);
  EXPECT_EQ(loaded.trajectory.poses[1].t.ns - loaded.trajectory.poses[0].t.ns, 2'000'000'000);
}

TEST(NmeaFile, TheFirstDateMayBeOnTheOtherSideOfMidnight) {
  const std::string before = "$GPGGA,235959,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,\n";
  const std::string after = "$GPGGA,000001,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,\n";
  const std::string date_after = "$GPRMC,000001,A,4807.038,N,01131.000,E,022.4,084.4,240394,003.1,W\n";
  const std::string date_before = "$GPRMC,235958,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W\n";
  for (const std::string& text : {before + after + date_after, before + date_after + after,
                                  date_before + before + after, date_before + after}) {
    // date -u -d "1994-03-24 00:00:01" +%s
    EXPECT_EQ(parse_nmea(text, "f").trajectory.poses.back().t.ns, 764467201'000'000'000) << text;
  }
  const std::string late =
      before + after + "$GPGGA,235959.5,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,\n";
  const LoadedTrajectory loaded = parse_nmea(late + date_after, "f");  // a row out of order begins no day
  EXPECT_EQ(loaded.trajectory.poses.back().t.ns, 764467201'000'000'000);
}

TEST(NmeaFile, RejectsTextsWithoutPositionOrDate) {
  expect_input_error([] { static_cast<void>(parse_nmea(kDate, "f")); }, {"f", "GGA"});
  expect_input_error([] { static_cast<void>(parse_nmea(kFirst, "f")); }, {"f", "RMC"});
}

TEST(NmeaFile, TakesNoDateFromAnInvalidSentence) {
  const std::string invalid = "$GPRMC,123518,V,,,,,,,060180,,\n";  // before the first fix
  const LoadedTrajectory loaded = parse_nmea(invalid + kDate + kFirst, "f");
  EXPECT_EQ(loaded.trajectory.poses[0].t.ns, 764426119'000'000'000);
  expect_input_error([&] { static_cast<void>(parse_nmea(invalid + kFirst, "f")); }, {"f", "status A"});
}

TEST(NmeaFile, IsDetectedIfTheLogStartsWithinASentence) {
  EXPECT_EQ(detect_format("225,N,08835.9985,W,1,08,0.9,545.4,M,46.9,M,,*79\r\n" + kFirst + kDate),
            TrajectoryFormat::kNmea);
  EXPECT_EQ(detect_format("*47\n\n" + kFirst), TrajectoryFormat::kNmea);
}

TEST(NmeaFile, IsDetected) {
  EXPECT_EQ(detect_format(kDate), TrajectoryFormat::kNmea);
  EXPECT_EQ(detect_format("1 0 0 0 0 0 0 1\n"), TrajectoryFormat::kTum);
}

}  // namespace
}  // namespace stillpoint::eval
