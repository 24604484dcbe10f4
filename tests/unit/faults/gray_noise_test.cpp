// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/gray_noise.h"

#include <gtest/gtest.h>

#include <memory>

#include <opencv2/core.hpp>

namespace stillpoint::datasets {
namespace {

/// Two images of gray level 100, with a column of 0 and one of 255.
class GrayFrames final : public SensorStream {
 public:
  GrayFrames() : image_(200, 300, CV_8UC1, cv::Scalar(100)) {
    info_.frame_times = {from_seconds(1.0), from_seconds(1.1)};
    image_.col(0) = 0;
    image_.col(1) = 255;
  }
  [[nodiscard]] const SequenceInfo& info() const override { return info_; }
  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    return {.id = static_cast<std::int64_t>(index), .t = info_.frame_times[index], .gray = image_};
  }
  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t /*index*/) const override {
    return std::nullopt;
  }

 private:
  SequenceInfo info_;
  cv::Mat image_;
};

cv::Mat noise_of(int seed, std::size_t index) {
  const Frame frame = with_gray_noise(std::make_unique<GrayFrames>(), seed)->load_frame(index);
  cv::Mat noise;
  cv::subtract(frame.gray, GrayFrames().load_frame(index).gray, noise, cv::noArray(), CV_16S);
  return noise;
}

bool are_equal(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

TEST(GrayNoise, HasNoMeanAndADeviationOfAGrayLevel) {
  // Rounding to whole levels adds a variance of 1/12: a deviation of 1.041. 59,600 pixels: mean 0 +- .004.
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(noise_of(1, 0).colRange(2, 300), mean, deviation);
  EXPECT_NEAR(mean[0], 0.0, 0.015);
  EXPECT_NEAR(deviation[0], 1.041, 0.015);
}

TEST(GrayNoise, DependsOnSeedAndFrameOnly) {
  EXPECT_TRUE(are_equal(noise_of(1, 0), noise_of(1, 0)));
  EXPECT_FALSE(are_equal(noise_of(1, 0), noise_of(2, 0)));
  EXPECT_FALSE(are_equal(noise_of(1, 0), noise_of(1, 1)));
}

TEST(GrayNoise, StaysWithinTheRangeOfPixelsAndTheSourceIsUnchanged) {
  double least = 0.0;
  double most = 0.0;
  cv::minMaxLoc(noise_of(3, 0).col(0), &least, &most);
  EXPECT_EQ(least, 0.0);
  EXPECT_GT(most, 0.0);
  cv::minMaxLoc(noise_of(3, 0).col(1), &least, &most);
  EXPECT_EQ(most, 0.0);
  EXPECT_LT(least, 0.0);
}

TEST(GrayNoise, SeedZeroIsTheStreamAsItIs) {
  EXPECT_TRUE(are_equal(noise_of(0, 0), cv::Mat::zeros(200, 300, CV_16S)));
  EXPECT_TRUE(with_gray_noise(std::make_unique<GrayFrames>(), 0)->info().notes.empty());
  EXPECT_EQ(with_gray_noise(std::make_unique<GrayFrames>(), 4)->info().notes.size(), 1U);
}

}  // namespace
}  // namespace stillpoint::datasets
