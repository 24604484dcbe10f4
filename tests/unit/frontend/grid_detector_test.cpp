// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/grid_detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "core/base/error.h"
#include "tests/unit/frontend/textured_image.h"

namespace stillpoint {
namespace {

const cv::Size kImageSize(160, 120);
constexpr int kRows = 3;  // cells of 40x40
constexpr int kCols = 4;
constexpr int kCells = kRows * kCols;

GridDetectorConfig small_grid() {
  GridDetectorConfig config;
  config.rows = kRows;
  config.cols = kCols;
  return config;
}

FeatureMask free_mask() {
  FeatureMask mask;
  mask.clear(kImageSize);
  return mask;
}

cv::Mat blank() { return {kImageSize, CV_8UC1, cv::Scalar(100)}; }

/// A single bright pixel: the only FAST corner. (The corners of a uniform square have neighbors of equal
/// score, so non-maximum suppression removes them.)
void draw_dot(cv::Mat& gray, const cv::Point& pixel, int brightness) {
  gray.at<std::uint8_t>(pixel) = static_cast<std::uint8_t>(brightness);
}

std::vector<cv::Point2f> detect(GridDetector& detector, const cv::Mat& gray, const FeatureMask& mask,
                                const std::vector<cv::Point2f>& tracked = {}, int wanted = 100) {
  return detector.detect(
      {.gray = gray, .mask = mask, .tracked = tracked, .wanted = wanted, .min_distance_px = 10});
}

TEST(GridDetector, FillsEachCellToItsQuota) {
  GridDetector detector(small_grid(), 2 * kCells);  // quota 2
  const cv::Mat gray = random_texture(kImageSize, 1);
  std::vector<int> per_cell(kCells, 0);
  for (const cv::Point2f& pixel : detect(detector, gray, free_mask())) {
    ++per_cell[static_cast<std::size_t>(static_cast<int>(pixel.y) / 40 * kCols +
                                        static_cast<int>(pixel.x) / 40)];
  }
  EXPECT_EQ(*std::max_element(per_cell.begin(), per_cell.end()), 2);
  EXPECT_GE(std::count(per_cell.begin(), per_cell.end(), 2), kCells - 2);  // two may be too close
}

TEST(GridDetector, QuotaIsRoundedUpAndTheTotalLimited) {
  GridDetector detector(small_grid(), kCells + 1);  // quota 2, so that all 13 are possible
  const cv::Mat gray = random_texture(kImageSize, 1);
  EXPECT_EQ(detect(detector, gray, free_mask(), {}, kCells + 1).size(), kCells + 1U);
  detector.reset();
  EXPECT_EQ(detect(detector, gray, free_mask(), {}, 5).size(), 5U);
  EXPECT_TRUE(detect(detector, gray, free_mask(), {}, 0).empty());
}

TEST(GridDetector, SearchesOnlyCellsBelowTheirQuota) {
  GridDetector detector(small_grid(), kCells);                                // quota 1
  const std::vector<cv::Point2f> tracked = {{20.0F, 20.0F}, {60.0F, 60.0F}};  // cells 0 and 5
  static_cast<void>(detect(detector, random_texture(kImageSize, 1), free_mask(), tracked));
  EXPECT_EQ(detector.searched_cells(), (std::vector<std::size_t>{1, 2, 3, 4, 6, 7, 8, 9, 10, 11}));
}

TEST(GridDetector, PrefersCellsWithFewFeaturesThenStrongCorners) {
  GridDetector detector(small_grid(), 2 * kCells);
  cv::Mat gray = blank();
  draw_dot(gray, {20, 20}, 250);   // cell 0, strongest, but the cell has a feature
  draw_dot(gray, {60, 20}, 140);   // cell 1
  draw_dot(gray, {100, 20}, 180);  // cell 2
  FeatureMask mask = free_mask();
  const std::vector<cv::Point2f> tracked = {{5.0F, 35.0F}};  // in cell 0
  const std::vector<cv::Point2f> found = detect(detector, gray, mask, tracked);
  EXPECT_EQ(found, (std::vector<cv::Point2f>{{100.0F, 20.0F}, {60.0F, 20.0F}, {20.0F, 20.0F}}));
}

TEST(GridDetector, SkipsAnEmptyCellExactlyOnce) {
  GridDetector detector(small_grid(), kCells);
  const cv::Mat gray = blank();
  static_cast<void>(detect(detector, gray, free_mask()));
  EXPECT_EQ(detector.searched_cells().size(), static_cast<std::size_t>(kCells));
  static_cast<void>(detect(detector, gray, free_mask()));
  EXPECT_TRUE(detector.searched_cells().empty());
  static_cast<void>(detect(detector, gray, free_mask()));
  EXPECT_EQ(detector.searched_cells().size(), static_cast<std::size_t>(kCells));
}

TEST(GridDetector, AMaskedCellCountsAsEmpty) {
  GridDetector detector(small_grid(), kCells);
  FeatureMask mask = free_mask();
  mask.occupy_circle({20.0F, 20.0F}, 40);  // covers cell 0, and parts of 1, 4 and 5
  const cv::Mat gray = random_texture(kImageSize, 1);
  for (const cv::Point2f& pixel : detect(detector, gray, mask)) EXPECT_TRUE(mask.is_free(pixel));
  static_cast<void>(detect(detector, gray, free_mask()));
  EXPECT_EQ(std::count(detector.searched_cells().begin(), detector.searched_cells().end(), 0U), 0);
}

TEST(GridDetector, ResetClearsTheSkippedCells) {
  GridDetector detector(small_grid(), kCells);
  static_cast<void>(detect(detector, blank(), free_mask()));
  detector.reset();
  static_cast<void>(detect(detector, blank(), free_mask()));
  EXPECT_EQ(detector.searched_cells().size(), static_cast<std::size_t>(kCells));
}

TEST(GridDetector, StopEarlyFindsTheSameCornersInFewerCells) {
  const cv::Mat gray = random_texture(kImageSize, 1);
  const std::vector<cv::Point2f> tracked = {{20.0F, 20.0F}, {60.0F, 60.0F}, {100.0F, 20.0F}};
  GridDetectorConfig config = small_grid();
  config.stop_early = false;
  GridDetector exhaustive(config, 2 * kCells);
  config.stop_early = true;
  GridDetector early(config, 2 * kCells);
  for (const int wanted : {4, 12, 20}) {  // more than enough, just enough and too few corners in empty cells
    exhaustive.reset();
    early.reset();
    EXPECT_EQ(detect(early, gray, free_mask(), tracked, wanted),
              detect(exhaustive, gray, free_mask(), tracked, wanted));
    EXPECT_EQ(exhaustive.searched_cells().size(), static_cast<std::size_t>(kCells));
    EXPECT_EQ(early.searched_cells().size(), wanted == 4 ? 9U : static_cast<std::size_t>(kCells));
  }
}

TEST(GridDetector, PaddingFindsCornersAtTheEdgeOfACell) {
  GridDetector detector(small_grid(), kCells);
  cv::Mat gray = blank();
  draw_dot(gray, {40, 40}, 250);   // first pixel of cell 5
  draw_dot(gray, {119, 79}, 250);  // last pixel of cell 6
  const std::vector<cv::Point2f> found = detect(detector, gray, free_mask());
  EXPECT_EQ(found, (std::vector<cv::Point2f>{{40.0F, 40.0F}, {119.0F, 79.0F}}));
}

TEST(GridDetector, NumberOfThreadsDoesNotChangeTheResult) {
  const cv::Mat gray = random_texture(kImageSize, 4);
  GridDetectorConfig config = small_grid();
  GridDetector serial(config, 3 * kCells);
  const std::vector<cv::Point2f> expected = detect(serial, gray, free_mask());
  for (config.threads = 2; config.threads <= 4; ++config.threads) {
    GridDetector parallel(config, 3 * kCells);
    EXPECT_EQ(detect(parallel, gray, free_mask()), expected) << config.threads;
  }
}

TEST(GridDetector, EveryPixelBelongsToACellOfAnUnevenGrid) {
  GridDetectorConfig config = small_grid();
  config.rows = 7;  // 120 / 7 and 160 / 11 leave remainders
  config.cols = 11;
  GridDetector detector(config, 77);
  std::vector<cv::Point2f> tracked;
  for (int y = 0; y < 120; y += 2) {
    for (int x = 0; x < 160; x += 2) tracked.emplace_back(static_cast<float>(x), static_cast<float>(y));
  }
  static_cast<void>(detect(detector, random_texture(kImageSize, 1), free_mask(), tracked));
  EXPECT_TRUE(detector.searched_cells().empty());
}

TEST(GridDetector, RejectsMoreCellsThanPixels) {
  GridDetectorConfig config;
  config.rows = 64;
  GridDetector detector(config, 130);
  FeatureMask mask;
  mask.clear(cv::Size(100, 50));
  EXPECT_THROW(static_cast<void>(detect(detector, cv::Mat(50, 100, CV_8UC1, cv::Scalar(0)), mask)),
               InputError);
}

}  // namespace
}  // namespace stillpoint
