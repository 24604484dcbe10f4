// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/bag_topics.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <vector>

#include "datasets/io/image_io.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

ImageMessage image_of(const std::string& encoding, std::uint32_t width, std::uint32_t step,
                      std::string_view data) {
  return {.header = {},
          .height = 1,
          .width = width,
          .encoding = encoding,
          .big_endian = false,
          .step = step,
          .data = data};
}

std::string file_bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(ImageMessage, ColorEncodingsBecomeRgb) {
  const cv::Vec3b expected(1, 2, 3);
  for (const auto& [encoding, data] :
       std::vector<std::pair<std::string, std::string>>{{"rgb8", "\1\2\3"},
                                                        {"bgr8", "\3\2\1"},
                                                        {"8UC3", "\3\2\1"},
                                                        {"rgba8", "\1\2\3\4"},
                                                        {"bgra8", "\3\2\1\4"}}) {
    const cv::Mat image = decode_color_message(image_of(encoding, 1, 4, data + "pad"), "bag");
    EXPECT_EQ(image.at<cv::Vec3b>(0, 0), expected) << encoding;
  }
  EXPECT_EQ(decode_color_message(image_of("mono8", 2, 2, "\7\x8"), "bag").at<std::uint8_t>(0, 1), 8);
}

TEST(ImageMessage, YuvIsConvertedByBt601) {
  // U = V = 128 is gray; V = 228 adds 1.402 * 100 to red and takes 0.714 * 100 off green.
  const std::string uyvy = "\x80\x32\x80\x64";
  const cv::Mat gray = decode_color_message(image_of("yuv422", 2, 4, uyvy), "bag");
  EXPECT_EQ(gray.at<cv::Vec3b>(0, 0), cv::Vec3b(50, 50, 50));
  EXPECT_EQ(gray.at<cv::Vec3b>(0, 1), cv::Vec3b(100, 100, 100));
  const cv::Mat red = decode_color_message(image_of("yuv422", 2, 4, "\x80\x64\xe4\x64"), "bag");
  EXPECT_EQ(red.at<cv::Vec3b>(0, 0), cv::Vec3b(240, 29, 100));
  const cv::Mat yuy2 = decode_color_message(image_of("yuv422_yuy2", 2, 4, "\x32\x80\x64\x80"), "bag");
  EXPECT_EQ(yuy2.at<cv::Vec3b>(0, 1), cv::Vec3b(100, 100, 100));
}

TEST(ImageMessage, TheNamesOfYuvInRos2AreThoseOfTheirOrder) {
  for (const auto& [ros1, ros2] :
       {std::pair<std::string, std::string>{"yuv422", "uyvy"}, {"yuv422_yuy2", "yuyv"}}) {
    EXPECT_EQ(content_of_encoding(ros2), ImageContent::kColor);
    const std::string data = "\x32\x80\x64\xe4";
    const cv::Mat image = decode_color_message(image_of(ros2, 2, 4, data), "bag");
    EXPECT_EQ(image.at<cv::Vec3b>(0, 1),
              decode_color_message(image_of(ros1, 2, 4, data), "bag").at<cv::Vec3b>(0, 1))
        << ros2;
  }
}

TEST(ImageMessage, APngOfOneChannelOfSixteenBitsIsDepth) {
  const TemporaryFolder folder;
  const auto content_of = [&folder](const cv::Mat& image) {
    write_png(folder.path() / "a.png", image);
    return content_of_compressed("png", "header" + file_bytes_of(folder.path() / "a.png"));
  };
  EXPECT_EQ(content_of(cv::Mat(4, 4, CV_16UC1, cv::Scalar(1234))), ImageContent::kDepth);
  EXPECT_EQ(content_of(cv::Mat(4, 4, CV_8UC1, cv::Scalar(12))), ImageContent::kColor);
  EXPECT_EQ(content_of(cv::Mat(4, 4, CV_8UC3, cv::Scalar(1, 2, 3))), ImageContent::kColor);
}

TEST(ImageMessage, DepthOfSixteenBitsIsRead) {
  ImageMessage image = image_of("16UC1", 2, 4, std::string_view("\1\2\0\0", 4));
  EXPECT_EQ(decode_depth_message(image, "bag").at<std::uint16_t>(0, 0), 0x0201);
  image.big_endian = true;
  EXPECT_EQ(decode_depth_message(image, "bag").at<std::uint16_t>(0, 0), 0x0102);
}

TEST(ImageMessage, DepthInMetersIsKept) {
  const std::vector<float> depth{1.0F, 1500.0F};  // in mm: not measured in 16 bits, which tell no unit
  std::string data(depth.size() * sizeof(float), '\0');
  std::memcpy(data.data(), depth.data(), data.size());
  const cv::Mat read = decode_depth_message(image_of("32FC1", 2, 8, data), "bag");
  ASSERT_EQ(read.type(), CV_32FC1);
  EXPECT_EQ(read.at<float>(0, 1), 1500.0F);
}

TEST(ImageMessage, DepthInMetersIsRoundedAndInvalidDepthIsZero) {
  const std::vector<float> depth{1.0F,  0.00031F, std::numeric_limits<float>::quiet_NaN(),
                                 -1.0F, 14.0F,    std::numeric_limits<float>::infinity()};
  std::string data(depth.size() * sizeof(float), '\0');
  std::memcpy(data.data(), depth.data(), data.size());
  const cv::Mat read = in_depth_units(decode_depth_message(image_of("32FC1", 6, 24, data), "bag"), 5000.0);
  EXPECT_EQ(std::vector<std::uint16_t>(read.begin<std::uint16_t>(), read.end<std::uint16_t>()),
            (std::vector<std::uint16_t>{5000, 2, 0, 0, 0, 0}));
}

TEST(ImageMessage, EveryDepthOf5000UnitsSurvivesTheConversionToMeters) {
  for (int raw = 1; raw <= 65535; ++raw) {
    const float meters = static_cast<float>(raw / 5000.0);
    std::string data(sizeof(float), '\0');
    std::memcpy(data.data(), &meters, sizeof(float));
    const cv::Mat read = decode_depth_message(image_of("32FC1", 1, 4, data), "bag");
    ASSERT_EQ(in_depth_units(read, kFloatDepthUnitsPerM).at<std::uint16_t>(0, 0), raw);
  }
}

TEST(ImageMessage, CompressedDepthHasAHeader) {
  const TemporaryFolder folder;
  const cv::Mat depth = (cv::Mat_<std::uint16_t>(1, 2) << 1234, 0);
  write_png(folder.path() / "d.png", depth);
  const std::string png = file_bytes_of(folder.path() / "d.png");
  const std::string data = std::string(12, '\0') + png;
  const cv::Mat read = decode_depth_message(
      CompressedImageMessage{.header = {}, .format = "16UC1; compressedDepth png", .data = data}, "bag");
  EXPECT_EQ(read.at<std::uint16_t>(0, 0), 1234);
  // Inverse depth: A = 2468, B = 0, so 1234 is 2 m.
  const float a = 2468.0F;
  std::string inverse = data;
  std::memcpy(inverse.data() + 4, &a, sizeof(a));
  const cv::Mat meters = decode_depth_message(
      CompressedImageMessage{.header = {}, .format = "32FC1; compressedDepth", .data = inverse}, "bag");
  EXPECT_EQ(meters.at<float>(0, 0), 2.0F);
  EXPECT_EQ(meters.at<float>(0, 1), 0.0F);
  EXPECT_EQ(decode_depth_message(
                CompressedImageMessage{.header = {}, .format = "16UC1; png compressed ", .data = png}, "bag")
                .at<std::uint16_t>(0, 0),
            1234);
  // Some publishers leave the header out; without it, the scale of inverse depth is not known.
  EXPECT_EQ(
      decode_depth_message(
          CompressedImageMessage{.header = {}, .format = "16UC1; compressedDepth png", .data = png}, "bag")
          .at<std::uint16_t>(0, 0),
      1234);
  expect_input_error(
      [&] {
        static_cast<void>(decode_depth_message(
            CompressedImageMessage{.header = {}, .format = "32FC1; compressedDepth", .data = png}, "bag"));
      },
      {"bag", "no header", "scale"});
}

TEST(ImageMessage, CompressedColorIsDecoded) {
  const TemporaryFolder folder;
  const cv::Mat color(8, 8, CV_8UC3, cv::Scalar(200, 100, 50));
  write_png(folder.path() / "c.png", color);
  write_jpeg(folder.path() / "c.jpg", color, 100);
  const std::string png = file_bytes_of(folder.path() / "c.png");
  const std::string jpeg = file_bytes_of(folder.path() / "c.jpg");
  EXPECT_EQ(decode_color_message(CompressedImageMessage{.header = {}, .format = "png", .data = png}, "bag")
                .at<cv::Vec3b>(3, 3),
            cv::Vec3b(200, 100, 50));
  const cv::Mat lossy = decode_color_message(
      CompressedImageMessage{.header = {}, .format = "bgr8; jpeg compressed bgr8", .data = jpeg}, "bag");
  EXPECT_LE(cv::norm(lossy.at<cv::Vec3b>(3, 3) - cv::Vec3b(200, 100, 50)), 5.0);
  const std::string part = jpeg.substr(0, jpeg.size() / 3);
  expect_input_error(
      [&] {
        static_cast<void>(decode_color_message(
            CompressedImageMessage{.header = {}, .format = "jpeg", .data = part}, "bag"));
      },
      {"bag"});
}

TEST(ImageMessage, UnknownEncodingsAndTooFewDataAreRejected) {
  expect_input_error(
      [] { static_cast<void>(decode_color_message(image_of("bayer_rggb8", 1, 1, "a"), "bag")); },
      {"bayer_rggb8", "--topics"});
  expect_input_error([] { static_cast<void>(decode_color_message(image_of("rgb8", 2, 6, "abc"), "bag")); },
                     {"does not fit its data"});
  expect_input_error([] { static_cast<void>(decode_depth_message(image_of("16UC1", 2, 2, "abcd"), "bag")); },
                     {"does not fit its data"});
  EXPECT_EQ(content_of_encoding("bayer_rggb8"), ImageContent::kOther);
  EXPECT_EQ(content_of_compressed("16UC1; compressedDepth", ""), ImageContent::kDepth);
}

}  // namespace
}  // namespace stillpoint::datasets
