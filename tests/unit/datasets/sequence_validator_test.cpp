// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sequence_validator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "datasets/io/image_io.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/sequences/sequence_folders.h"
#include "tests/support/test_data.h"

namespace stillpoint::datasets {
namespace {

std::size_t count(const CheckReport& report, const std::string& location, const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(report.findings.begin(), report.findings.end(), [&](const Finding& finding) {
        return finding.location.find(location) != std::string::npos &&
               finding.text.find(text) != std::string::npos;
      }));
}

/// Rows of a stationary sensor at 400 Hz from 99.9 s over 0.3 s.
std::string stationary_rows(const char* value) {
  std::string text;
  for (int i = 0; i <= 120; ++i) text += std::to_string(99.9 + i / 400.0) + " 0 " + value + " 0\n";
  return text;
}

/// A portable float map: rows from the last to the first, little-endian.
void write_pfm(const std::filesystem::path& file, const cv::Mat& image) {
  std::ofstream stream(file, std::ios::binary);
  stream << "Pf\n" << image.cols << ' ' << image.rows << "\n-1.0\n";
  for (int row = image.rows - 1; row >= 0; --row)
    stream.write(reinterpret_cast<const char*>(image.ptr(row)), 4 * image.cols);
}

void write_valid_sequence(const TemporaryFolder& folder) {
  write_openloris_folder(folder);
  folder.write("d400_accelerometer.txt", stationary_rows("-9.8"));
}

TEST(SequenceValidator, AValidSequenceHasNoFindings) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  const CheckReport report = check_sequence(folder.path());
  EXPECT_EQ(report.exit_code(), 0) << report_text(report);
  ASSERT_EQ(report.streams.size(), 3U);
  EXPECT_EQ(report.streams[0].count, 3U);
  EXPECT_NEAR(report.streams[0].rate_hz, 25.0, 1e-6);  // every 40 ms
  EXPECT_NEAR(report.streams[1].rate_hz, 400.0, 1e-2);
  EXPECT_NEAR(report.streams[1].first_s, -0.1, 1e-9);
  EXPECT_NEAR(report.streams[2].rate_hz, 100.0, 1e-6);
  EXPECT_NE(report_text(report).find("no findings"), std::string::npos);
}

TEST(SequenceValidator, ReportsMissingTruncatedAndWrongSizeImagesTogether) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  std::filesystem::remove(folder.path() / "color/100.000000.png");
  std::filesystem::resize_file(folder.path() / "color/100.040000.png", 40);
  write_png(folder.path() / "aligned_depth/100.080000.png", cv::Mat(5, 8, CV_16UC1, cv::Scalar(1)));
  const CheckReport report = check_sequence(folder.path());
  EXPECT_EQ(report.exit_code(), 1);
  EXPECT_EQ(report.findings.size(), 3U) << report_text(report);
  EXPECT_EQ(count(report, "100.000000.png", "no such image"), 1U);
  EXPECT_EQ(count(report, "100.040000.png", "copy the file again"), 1U);
  EXPECT_EQ(count(report, "100.080000.png", "is 8x5"), 1U);
}

TEST(SequenceValidator, ReportsEveryFaultyRowWithItsLine) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  folder.write(
      "d400_gyroscope.txt",
      "99.9 0 0 0\n99.95 0 0 0\n99.95 0 0 0\n99.92 0 0 0\n100.0 nan 0 0\n100.05 0 0 0\n100.1 0 0 0\n");
  const CheckReport report = check_sequence(folder.path());
  EXPECT_EQ(count(report, "d400_gyroscope.txt:3", "repeats"), 1U);
  EXPECT_EQ(count(report, "d400_gyroscope.txt:4", "earlier than the previous row"), 1U);
  EXPECT_EQ(count(report, "d400_gyroscope.txt:5", "not finite"), 1U);
  EXPECT_EQ(report.findings.size(), 3U) << report_text(report);
}

TEST(SequenceValidator, FaultyRowsThatLeaveNothingAreTheError) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  folder.write("rgb.txt", "rgb/1.000000.png\nrgb/1.040000.png\n");
  expect_input_error([&] { static_cast<void>(check_sequence(folder.path())); },
                     {"rgb.txt:1", "rgb/1.000000.png"});
  std::filesystem::remove(folder.path() / "rgb.txt");
  folder.write("associations.txt", "1700000000050 rgb/1.000000.png 1700000000050 depth/1.005000.png\n");
  expect_input_error([&] { static_cast<void>(check_sequence(folder.path())); },
                     {"associations.txt:1", "1700000000050"});
}

TEST(SequenceValidator, WarnsAboutFrameNumbersAndOtherUnitsInThePlaceOfSeconds) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  std::filesystem::remove(folder.path() / "groundtruth.txt");
  const auto warnings_at = [&](std::int64_t start, std::int64_t step) {
    std::string color;
    std::string depth;
    for (int i = 0; i < 10; ++i) {
      color += std::to_string(start + i * step) + " rgb/1.000000.png\n";
      depth += std::to_string(start + i * step) + " depth/1.005000.png\n";
    }
    folder.write("rgb.txt", color);
    folder.write("depth.txt", depth);
    return count(check_sequence(folder.path()), "images",
                 "whole numbers, the first two " + std::to_string(step) + " s apart");
  };
  EXPECT_EQ(warnings_at(0, 1), 1U);
  EXPECT_EQ(warnings_at(0, 33'333'333), 1U);  // ns
  EXPECT_EQ(warnings_at(1'700'000'000, 1), 0U);
}

TEST(SequenceValidator, ReportsGaps) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  std::string truth;
  for (int i = 0; i <= 30; ++i) {
    if (i < 12 || i > 15) truth += std::to_string(99.9 + 0.01 * i) + " 0 0 0 0 0 0 1\n";
  }
  folder.write("groundtruth.txt", truth);
  const CheckReport report = check_sequence(folder.path());
  ASSERT_EQ(report.findings.size(), 1U) << report_text(report);
  // The last pose before the gap is at 99.9 + 0.11 s, the first after it 50 ms later.
  EXPECT_EQ(count(report, "ground truth",
                  "1 gap(s) longer than 2.5 median intervals; the longest (0.050 s) starts 0.010 s"),
            1U);
}

TEST(SequenceValidator, ReportsStreamsThatDoNotCoverAllImages) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  folder.write("groundtruth.txt",
               "99.80 0 0 0 0 0 0 1\n99.85 0 0 0 0 0 0 1\n99.90 0 0 0 0 0 0 1\n99.95 0 0 0 0 0 0 1\n"
               "100.00 0 0 0 0 0 0 1\n");
  folder.write("d400_gyroscope.txt", "100.02 0 0 0\n100.05 0 0 0\n100.1 0 0 0\n");
  const CheckReport report = check_sequence(folder.path());
  EXPECT_EQ(count(report, "imu", "does not cover 1 of 3 images"), 1U) << report_text(report);
  EXPECT_EQ(count(report, "ground truth", "covers"), 0U);  // 100.08 is 80 ms from a pose: covered
}

TEST(SequenceValidator, ReportsMissingOverlapAsAFinding) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  folder.write("groundtruth.txt", "500.0 0 0 0 0 0 0 1\n");
  const CheckReport report = check_sequence(folder.path());
  EXPECT_EQ(count(report, "", "no overlap in time"), 1U);
  EXPECT_EQ(count(report, "ground truth", "covers 0 of 3 images"), 1U);
}

TEST(SequenceValidator, WarnsAboutTheUnitOfAccelerations) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  folder.write("d400_accelerometer.txt", stationary_rows("1"));  // in g
  EXPECT_EQ(count(check_sequence(folder.path()), "imu", "m/s^2"), 1U);
}

TEST(SequenceValidator, ReportsValuesThatNoSensorMeasures) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  folder.write("d400_gyroscope.txt", "99.9 0 0 0\n99.95 1e30 0 0\n100.0 0 0 0\n100.05 0 0 0\n100.1 0 0 0\n");
  const CheckReport report = check_sequence(folder.path());
  EXPECT_EQ(count(report, "d400_gyroscope.txt:2", "exceeds 100 rad/s"), 1U) << report_text(report);
  EXPECT_EQ(report.exit_code(), 1);
}

TEST(SequenceValidator, WarnsAboutALowRateOfTheImu) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  for (const double rate_hz : {20.0, 100.0}) {
    std::string rates, accelerations;
    for (int i = 0; i <= 40; ++i) {
      const std::string stamp = std::to_string(99.5 + i / rate_hz);
      rates += stamp + " 0 0 0\n";
      accelerations += stamp + " 0 -9.8 0\n";
    }
    folder.write("d400_gyroscope.txt", rates);
    folder.write("d400_accelerometer.txt", accelerations);
    EXPECT_EQ(count(check_sequence(folder.path()), "imu", "sampled at 20 Hz"), rate_hz < 50.0 ? 1U : 0U);
  }
}

TEST(SequenceValidator, ReportsAGapOfOneInertialSensor) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  std::string rows;
  for (int i = 0; i <= 120; ++i) {
    if (i < 30 || i > 70) rows += std::to_string(99.9 + i / 400.0) + " 0 -9.8 0\n";
  }
  folder.write("d400_accelerometer.txt", rows);
  const CheckReport report = check_sequence(folder.path());
  // The last sample before the gap is the 30th, 72.5 ms after 99.9 s; the gap is 42 samples of 2.5 ms long.
  EXPECT_EQ(count(report, "imu", "1 gap(s) longer than 2.5 median intervals; the longest (0.105 s)"), 1U)
      << report_text(report);
}

TEST(SequenceValidator, ReportsRepeatedStampsOfTheGroundTruth) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  std::string truth;
  for (int i = 0; i <= 30; ++i) {
    for (int copy = 0; copy < (i == 7 ? 3 : 1); ++copy)
      truth += std::to_string(99.9 + 0.01 * i) + " 0 0 0 0 0 0 1\n";
  }
  folder.write("groundtruth.txt", truth);
  const CheckReport report = check_sequence(folder.path());
  ASSERT_EQ(report.findings.size(), 1U) << report_text(report);
  EXPECT_EQ(report.findings[0].severity, Severity::kWarning);
  EXPECT_EQ(count(report, "ground truth", "2 rows skipped: the time stamp repeats"), 1U);
}

TEST(SequenceValidator, ReportsImagesWithoutRecordedBoxes) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  folder.write("detections.txt", "100.0\n100.05\n100.08\n");  // the second image is at 100.04 s
  EXPECT_EQ(check_sequence(folder.path()).findings.size(), 0U);
  folder.write("detections.txt", "100.0\n100.08\n");
  EXPECT_EQ(count(check_sequence(folder.path()), "detections", "cover 2 of 3 images"), 1U);
}

TEST(SequenceValidator, ReportsALargeTimeOffsetOfDepth) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  EXPECT_EQ(check_sequence(folder.path()).findings.size(), 0U);
  EXPECT_NEAR(check_sequence(folder.path()).depth_offset_s, 0.005, 1e-9);
  folder.write("depth.txt", "1.015 depth/1.005000.png\n1.055 depth/1.045000.png\n1.095 depth/1.085000.png\n");
  EXPECT_EQ(count(check_sequence(folder.path()), "depth", "by 15.0 ms"), 1U);
}

TEST(SequenceValidator, ReportsDepthImagesWithoutValidPixels) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  write_png(folder.path() / "depth/1.045000.png", cv::Mat::zeros(6, 8, CV_16UC1));
  EXPECT_EQ(count(check_sequence(folder.path()), "1.045000.png", "no measured depth"), 1U);
}

TEST(SequenceValidator, NamesTheUnitOfDepthImagesOfFloats) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  std::string list;
  for (const std::string stamp : {"1.005000", "1.045000", "1.085000"}) {
    cv::Mat depth(6, 8, CV_32FC1, cv::Scalar(1500.0));  // in mm
    depth.at<float>(0, 0) = 4000.0F;
    write_pfm(folder.path() / ("depth/" + stamp + ".pfm"), depth);
    list += stamp + " depth/" + stamp + ".pfm\n";
  }
  folder.write("depth.txt", list);
  const CheckReport report = check_sequence(folder.path());
  EXPECT_EQ(count(report, "depth", "read as meters"), 1U) << report_text(report);
  EXPECT_EQ(count(report, "depth", "Divided by 1000, they are from 1.50 to"), 1U) << report_text(report);
  EXPECT_EQ(count(report, "depth", "convert them to meters"), 1U);
}

TEST(SequenceValidator, RejectsAFolderThatIsNotASequence) {
  const TemporaryFolder folder;
  expect_input_error([&] { static_cast<void>(check_sequence(folder.path())); },
                     {"not a sequence of a supported format"});
}

TEST(SequenceValidator, TruncatesLongListsOfFindings) {
  const TemporaryFolder folder;
  write_valid_sequence(folder);
  std::string rows = "99.9 0 0 0\n";
  for (int i = 0; i < 20; ++i) rows += "99.9 0 0 0\n";
  folder.write("d400_gyroscope.txt", rows + "100.1 0 0 0\n");
  const std::string text = report_text(check_sequence(folder.path()));
  EXPECT_NE(text.find("... 15 more in "), std::string::npos) << text;
}

TEST(SequenceValidator, RealTwoPeopleSequenceHasNoFindings) {
  const auto folder = find_test_data("two_people_d435");
  if (!folder) GTEST_SKIP() << missing_test_data("two_people_d435");
  const CheckReport report = check_sequence(*folder);
  EXPECT_EQ(report.exit_code(), 0) << report_text(report);
  EXPECT_EQ(report.streams[0].count, 40U);
}

}  // namespace
}  // namespace stillpoint::datasets
