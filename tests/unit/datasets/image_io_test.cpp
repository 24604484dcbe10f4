// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/image_io.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

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

TEST(ImageIo, ANamedPipeIsAnErrorAndNotWaitedFor) {
  const TemporaryFolder folder;
  const std::filesystem::path pipe = folder.path() / "image.png";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_input_error([&] { static_cast<void>(read_image(pipe)); }, {"image.png", "no such image"});
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
  write_png(folder.path() / "depth.png", noise_image(CV_16UC1));
  expect_input_error([&] { static_cast<void>(read_depth(folder.path() / "color.png")); },
                     {"3 channel(s) of 8 bits"});
  expect_input_error([&] { static_cast<void>(read_image(folder.path() / "depth.png")); },
                     {"16 bits per channel"});
}

TEST(ImageIo, AFullDiskIsAnErrorAndLeavesNoFile) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "/dev/full does not exist";
  const TemporaryFolder folder;
  // write_png first writes to the name with the suffix ".part"; a link to /dev/full simulates a full disk.
  std::filesystem::create_symlink("/dev/full", folder.path() / "a.png.part");
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
