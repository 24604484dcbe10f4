// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/cache/frame_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/sequences/cached_sequence.h"

namespace stillpoint::datasets {
namespace {

const cv::Size kSize(kCachedWidth, kCachedHeight);

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         std::equal(a.datastart, a.dataend, b.datastart, b.dataend);
}

TEST(FrameCodec, ReturnsNoiseUnchanged) {
  const cv::Mat gray = noise_image<std::uint8_t>(CV_8UC1, 1);
  const cv::Mat depth = noise_image<std::uint16_t>(CV_16UC1, 2);
  EXPECT_TRUE(equal(*unpack_gray(pack_gray(gray), kSize), gray));
  EXPECT_TRUE(equal(*unpack_depth(pack_depth(depth), kSize), depth));
}

TEST(FrameCodec, CompressesSmoothImages) {
  cv::Mat gray(kSize, CV_8UC1);
  cv::Mat depth(kSize, CV_16UC1);
  for (int row = 0; row < kSize.height; ++row) {
    for (int column = 0; column < kSize.width; ++column) {
      gray.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(3 * column + 7 * row);
      depth.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(1000 + column);
    }
  }
  const std::string packed = pack_gray(gray);
  EXPECT_LT(packed.size(), gray.total() / 4);
  EXPECT_LT(pack_depth(depth).size(), depth.total());
  EXPECT_TRUE(equal(*unpack_gray(packed, kSize), gray));
}

TEST(FrameCodec, PacksPartsOfLargerImages) {
  const cv::Mat part = noise_image<std::uint16_t>(CV_16UC1, 3)(cv::Rect(5, 4, 20, 10));
  EXPECT_TRUE(equal(*unpack_depth(pack_depth(part), part.size()), part.clone()));
}

TEST(FrameCodec, RejectsOtherSizesAndOtherBytes) {
  const std::string packed = pack_gray(noise_image<std::uint8_t>(CV_8UC1, 1));
  EXPECT_FALSE(unpack_gray(packed, {kCachedWidth, kCachedHeight + 1}));
  EXPECT_FALSE(unpack_gray(packed.substr(0, packed.size() / 2), kSize));
  EXPECT_FALSE(unpack_gray("", kSize));
  EXPECT_FALSE(unpack_gray(std::string(100, 'x'), kSize));
}

}  // namespace
}  // namespace stillpoint::datasets
