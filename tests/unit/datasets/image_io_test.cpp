// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/image_io.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fstream>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

cv::Mat noise_image(int type) {
  cv::Mat image(48, 64, type);
  std::uint32_t state = 1;  // incompressible, so that a truncated file lacks pixels
  for (std::size_t i = 0; i < image.total() * image.elemSize(); ++i) {
    state = state * 1664525U + 1013904223U;
    image.data[i] = static_cast<std::uint8_t>(state >> 24);
  }
  return image;
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && a.isContinuous() && b.isContinuous() &&
         std::equal(a.data, a.data + a.total() * a.elemSize(), b.data);
}

void truncate_by_half(const std::filesystem::path& file) {
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
}

/// Bytes of a number, little-endian.
template <class Number>
std::string bytes_of_number(Number value) {
  return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

std::string bytes_of_floats(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

/// A TIFF of one row of 32-bit floats without compression (TIFF 6.0, sections 2 and 8, SampleFormat 3).
std::string float_tiff(const std::vector<float>& row) {
  const auto size = static_cast<std::uint32_t>(row.size());
  const std::vector<std::pair<std::uint16_t, std::uint32_t>> entries = {
      {256, size}, {257, 1}, {258, 32}, {259, 1},        {262, 1},
      {273, 8},    {277, 1}, {278, 1},  {279, 4 * size}, {339, 3}};
  std::string directory = bytes_of_number(static_cast<std::uint16_t>(entries.size()));
  for (const auto& [tag, value] : entries)
    directory += bytes_of_number(tag) + bytes_of_number(std::uint16_t{4}) +
                 bytes_of_number(std::uint32_t{1}) + bytes_of_number(value);
  return "II" + bytes_of_number(std::uint16_t{42}) + bytes_of_number(8 + 4 * size) + bytes_of_floats(row) +
         directory + bytes_of_number(std::uint32_t{0});
}

/// An OpenEXR file of one row of 32-bit floats without compression ("OpenEXR File Layout").
std::string float_exr(const std::vector<float>& row) {
  const std::string zero(1, '\0');
  const auto attribute = [&zero](const std::string& name, const std::string& type, const std::string& value) {
    return name + zero + type + zero + bytes_of_number(static_cast<std::int32_t>(value.size())) + value;
  };
  const auto number = [](auto value) { return bytes_of_number(value); };
  const std::string channel = "Y" + zero + number(std::int32_t{2}) + std::string(4, '\0') +
                              number(std::int32_t{1}) + number(std::int32_t{1});
  const auto width = static_cast<std::int32_t>(row.size());
  const std::string window = std::string(8, '\0') + number(width - 1) + number(std::int32_t{0});
  const std::string header =
      number(std::int32_t{20000630}) + number(std::int32_t{2}) +
      attribute("channels", "chlist", channel + zero) + attribute("compression", "compression", zero) +
      attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window) +
      attribute("lineOrder", "lineOrder", zero) + attribute("pixelAspectRatio", "float", number(1.0F)) +
      attribute("screenWindowCenter", "v2f", std::string(8, '\0')) +
      attribute("screenWindowWidth", "float", number(1.0F)) + zero;
  return header + number(static_cast<std::uint64_t>(header.size() + 8)) + number(std::int32_t{0}) +
         number(4 * width) + bytes_of_floats(row);
}

TEST(ImageIo, PngRoundTripIsLossless) {
  const TemporaryFolder folder;
  for (const int type : {CV_8UC1, CV_8UC3}) {
    write_png(folder.path() / "image.png", noise_image(type));
    EXPECT_TRUE(equal(read_image(folder.path() / "image.png"), noise_image(type)));
  }
  write_png(folder.path() / "depth.png", noise_image(CV_16UC1));
  EXPECT_TRUE(equal(read_depth(folder.path() / "depth.png"), noise_image(CV_16UC1)));
}

TEST(ImageIo, WritesAViewWithNonContiguousRows) {
  const TemporaryFolder folder;
  const cv::Mat view = noise_image(CV_16UC1)(cv::Rect(3, 5, 20, 10));
  write_png(folder.path() / "view.png", view);
  EXPECT_TRUE(equal(read_depth(folder.path() / "view.png"), view.clone()));
}

TEST(ImageIo, JpegApproximatesAUniformColorInASmallFile) {
  const TemporaryFolder folder;
  const cv::Mat uniform(48, 64, CV_8UC3, cv::Scalar(200, 120, 40));
  write_jpeg(folder.path() / "uniform.jpg", uniform);
  const cv::Vec3b pixel = read_image(folder.path() / "uniform.jpg").at<cv::Vec3b>(20, 30);
  EXPECT_NEAR(pixel[0], 200, 3);  // rounding of the color transform and of one coefficient
  EXPECT_NEAR(pixel[1], 120, 3);
  EXPECT_NEAR(pixel[2], 40, 3);
  EXPECT_LT(std::filesystem::file_size(folder.path() / "uniform.jpg"), 48u * 64u);
}

TEST(ImageIo, JpegIntoAMissingFolderIsAnError) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_jpeg(folder.path() / "missing" / "a.jpg", cv::Mat(8, 8, CV_8UC3)), InputError);
}

TEST(ImageIo, GrayIsTheRoundedLuma) {
  cv::Mat rgb(1, 3, CV_8UC3);
  rgb.at<cv::Vec3b>(0, 0) = {255, 0, 0};
  rgb.at<cv::Vec3b>(0, 1) = {10, 200, 30};
  rgb.at<cv::Vec3b>(0, 2) = {255, 255, 255};
  const cv::Mat gray = to_gray(rgb);
  EXPECT_EQ(gray.at<std::uint8_t>(0, 0), 76);   // 0.299 * 255 = 76.2
  EXPECT_EQ(gray.at<std::uint8_t>(0, 1), 124);  // 2.99 + 117.4 + 3.42 = 123.8
  EXPECT_EQ(gray.at<std::uint8_t>(0, 2), 255);
}

TEST(ImageIo, MissingImageIsAnError) {
  const TemporaryFolder folder;
  expect_input_error([&] { static_cast<void>(read_image(folder.path() / "no.png")); },
                     {"no.png", "no such image"});
}

TEST(ImageIo, TruncatedImagesAreErrors) {
  const TemporaryFolder folder;
  write_png(folder.path() / "a.png", noise_image(CV_8UC3));
  write_png(folder.path() / "b.png", noise_image(CV_16UC1));
  truncate_by_half(folder.path() / "a.png");
  truncate_by_half(folder.path() / "b.png");
  expect_input_error([&] { static_cast<void>(read_image(folder.path() / "a.png")); }, {"a.png", "truncated"});
  expect_input_error([&] { static_cast<void>(read_depth(folder.path() / "b.png")); }, {"b.png", "truncated"});
}

TEST(ImageIo, AnImageForWhichThereIsHardlyMemoryIsAnError) {
  const TemporaryFolder folder;
  expect_input_error(
      [&] { static_cast<void>(read_image(folder.write("large.ppm", "P6\n60000 60000\n255\n"))); },
      {"large.ppm", "60000 x 60000 pixels", "reduce its size"});
}

TEST(ImageIo, ANamedPipeIsAnErrorAndNotWaitedFor) {
  const TemporaryFolder folder;
  const std::filesystem::path pipe = folder.path() / "image.png";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_input_error([&] { static_cast<void>(read_image(pipe)); }, {"image.png", "no such image"});
}

TEST(ImageIo, ADamagedPngIsOneErrorAndTheLibraryPrintsNothing) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.png";
  write_png(file, noise_image(CV_8UC3));
  std::fstream(file, std::ios::binary | std::ios::in | std::ios::out).seekp(3000).write("damaged", 7);
  testing::internal::CaptureStderr();
  expect_input_error([&] { static_cast<void>(read_image(file)); },
                     {"a.png", "is damaged", "checksum of its chunk IDAT", "copy the file again"});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ImageIo, TextAndEmptyFilesAreErrors) {
  const TemporaryFolder folder;
  const auto text = folder.write("text.png", "not an image");
  const auto empty = folder.write("empty.jpg", "");
  expect_input_error([&] { static_cast<void>(read_image(text)); }, {"text.png", "not a PNG"});
  expect_input_error([&] { static_cast<void>(read_image(empty)); }, {"empty.jpg", "cannot be decoded"});
}

TEST(ImageIo, ReadingColorAsDepthOrDepthAsColorIsAnError) {
  const TemporaryFolder folder;
  write_png(folder.path() / "color.png", noise_image(CV_8UC3));
  expect_input_error([&] { static_cast<void>(read_depth(folder.path() / "color.png")); },
                     {"3 channel(s) of 8 bits"});
  const std::filesystem::path meters = folder.write("depth.tif", float_tiff({1.0F, 2.0F}));
  expect_input_error([&] { static_cast<void>(read_image(meters)); }, {"depth.tif", "32 bits per channel"});
}

TEST(ImageIo, OfGrayValuesOf16BitsTheUpper8AreUsed) {
  const TemporaryFolder folder;
  const cv::Mat deep = (cv::Mat_<std::uint16_t>(1, 3) << 0x12ff, 0, 0xffff);
  write_png(folder.path() / "deep.png", deep);
  const cv::Mat expected = (cv::Mat_<std::uint8_t>(1, 3) << 0x12, 0, 0xff);
  EXPECT_TRUE(equal(read_image(folder.path() / "deep.png"), expected));
  EXPECT_TRUE(equal(read_gray(folder.path() / "deep.png").image, expected));
  EXPECT_FALSE(read_gray(folder.path() / "deep.png").is_color);
  EXPECT_EQ(largest_deep_gray(folder.path() / "deep.png"), 0xffff);
  write_png(folder.path() / "gray.png", noise_image(CV_8UC1));
  EXPECT_FALSE(largest_deep_gray(folder.path() / "gray.png"));
  EXPECT_FALSE(largest_deep_gray(folder.path() / "none.png"));
}

TEST(ImageIo, DepthInMetersIsReadFromTiffAndOpenExr) {
  const TemporaryFolder folder;
  const std::vector<float> meters = {0.5F, 1.25F, 0.0F, std::numeric_limits<float>::quiet_NaN(), 7.0F};
  for (const auto& [name, bytes] :
       {std::pair("d.tif", float_tiff(meters)), std::pair("d.exr", float_exr(meters))}) {
    const cv::Mat depth = read_depth(folder.write(name, bytes));
    ASSERT_EQ(depth.type(), CV_32FC1) << name;
    ASSERT_EQ(depth.cols, 5) << name;
    EXPECT_EQ(depth.at<float>(0, 1), 1.25F) << name;
    EXPECT_EQ(depth.at<float>(0, 4), 7.0F) << name;
  }
}

TEST(ImageIo, AJpegNamedPngIsReadByItsContent) {
  const TemporaryFolder folder;
  write_jpeg(folder.path() / "image.png", cv::Mat(8, 8, CV_8UC3, cv::Scalar(200, 100, 50)), 100);
  const cv::Vec3b pixel = read_image(folder.path() / "image.png").at<cv::Vec3b>(3, 3);
  EXPECT_LE(cv::norm(pixel - cv::Vec3b(200, 100, 50)), 5.0);
}

TEST(ImageIo, AFullDiskIsAnErrorAndLeavesNoFile) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "/dev/full does not exist";
  const TemporaryFolder folder;
  // write_png first writes to a name with the process and the suffix ".part"; a link to /dev/full simulates a
  // full disk.
  std::filesystem::create_symlink("/dev/full",
                                  folder.path() / ("a.png." + std::to_string(::getpid()) + ".part"));
  expect_input_error([&] { write_png(folder.path() / "a.png", noise_image(CV_8UC3)); },
                     {"a.png", "disk is not full"});
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ImageIo, AMissingOutputFolderIsAnErrorAndLeavesNoFile) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "absent" / "a.png";
  expect_input_error([&] { write_png(file, noise_image(CV_8UC1)); }, {"a.png", "cannot be written"});
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace stillpoint::datasets
