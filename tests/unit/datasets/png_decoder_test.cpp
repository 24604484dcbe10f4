// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/image_io.h"

#include <gtest/gtest.h>
#include <isa-l/crc.h>
#include <isa-l/igzip_lib.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace stillpoint::datasets {
namespace {

constexpr int kWidth = 13;
constexpr int kHeight = 10;

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift & 0xFF);
  return bytes;
}

std::uint8_t* bytes_of(std::string& text) { return reinterpret_cast<std::uint8_t*>(text.data()); }

std::string chunk(const std::string& type, const std::string& data) {
  std::string content = type + data;
  return big_endian(static_cast<std::uint32_t>(data.size())) + content +
         big_endian(crc32_gzip_refl(0, bytes_of(content), content.size()));
}

std::string compressed(std::string bytes) {
  std::string out(2 * bytes.size() + 1000, '\0');
  isal_zstream stream;
  isal_deflate_stateless_init(&stream);
  stream.gzip_flag = IGZIP_ZLIB;
  stream.end_of_stream = 1;
  stream.next_in = bytes_of(bytes), stream.avail_in = static_cast<std::uint32_t>(bytes.size());
  stream.next_out = bytes_of(out), stream.avail_out = static_cast<std::uint32_t>(out.size());
  EXPECT_EQ(isal_deflate_stateless(&stream), COMP_OK);
  out.resize(stream.total_out);
  return out;
}

/// Prediction of a byte by its neighbors, PNG specification Sec. 9.2.
int prediction(int filter, int left, int above, int above_left) {
  if (filter == 1) return left;
  if (filter == 2) return above;
  if (filter == 3) return (left + above) / 2;
  if (filter == 0) return 0;
  const int p = left + above - above_left;
  const int distance = std::min({std::abs(p - left), std::abs(p - above), std::abs(p - above_left)});
  if (std::abs(p - left) == distance) return left;
  return std::abs(p - above) == distance ? above : above_left;
}

/// The stored bytes of a row; 16-bit values have the high byte first.
std::vector<int> row_bytes(const cv::Mat& image, int row) {
  std::vector<int> bytes;
  if (row < 0) return std::vector<int>(static_cast<std::size_t>(image.cols) * image.elemSize(), 0);
  for (int i = 0; i < image.cols * image.channels(); ++i) {
    const int value =
        image.depth() == CV_16U ? image.ptr<std::uint16_t>(row)[i] : image.ptr<std::uint8_t>(row)[i];
    if (image.depth() == CV_16U) bytes.push_back(value >> 8);
    bytes.push_back(value & 0xFF);
  }
  return bytes;
}

/// The rows with the five filters in turn.
std::string filtered_rows(const cv::Mat& image) {
  std::string bytes;
  const std::size_t pixel = image.elemSize();
  for (int row = 0; row < image.rows; ++row) {
    const int filter = row % 5;
    const std::vector<int> values = row_bytes(image, row);
    const std::vector<int> above = row_bytes(image, row - 1);
    bytes += static_cast<char>(filter);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const bool first = i < pixel;
      const int predicted =
          prediction(filter, first ? 0 : values[i - pixel], above[i], first ? 0 : above[i - pixel]);
      bytes += static_cast<char>(values[i] - predicted);
    }
  }
  return bytes;
}

std::string header(const cv::Mat& image, bool interlaced = false) {
  const char depth = image.depth() == CV_16U ? 16 : 8;
  const char color_type = image.channels() == 3 ? 2 : 0;
  return chunk("IHDR", big_endian(static_cast<std::uint32_t>(image.cols)) +
                           big_endian(static_cast<std::uint32_t>(image.rows)) +
                           std::string{depth, color_type, 0, 0, interlaced ? '\1' : '\0'});
}

const std::string kSignature = "\x89PNG\r\n\x1a\n";

std::string png_of(const cv::Mat& image) {
  const std::string data = compressed(filtered_rows(image));
  return kSignature + header(image) + chunk("gAMA", big_endian(45455)) + chunk("IDAT", data.substr(0, 20)) +
         chunk("IDAT", data.substr(20)) + chunk("IEND", "");
}

cv::Mat noise(int type) {
  cv::Mat image(kHeight, kWidth, type);
  std::uint32_t state = 1;
  for (std::size_t i = 0; i < image.total() * image.elemSize(); ++i) {
    state = state * 1664525U + 1013904223U;
    image.data[i] = static_cast<std::uint8_t>(state >> 24);
  }
  return image;
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() &&
         std::equal(a.datastart, a.dataend, b.datastart, b.dataend);
}

TEST(PngDecoder, DecodesAllFiltersOfAllSupportedKinds) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
    const std::optional<DecodedPng> png = decode_png(png_of(noise(type)));
    ASSERT_TRUE(png);
    EXPECT_TRUE(equal(png->image, noise(type)));
    EXPECT_EQ(png->is_color, type == CV_8UC3);
  }
}

TEST(PngDecoder, GrayIsThatOfTheColorImage) {
  const std::optional<DecodedPng> png = decode_png(png_of(noise(CV_8UC3)), PngPixels::kGray);
  ASSERT_TRUE(png);
  EXPECT_TRUE(equal(png->image, to_gray(noise(CV_8UC3))));
  EXPECT_TRUE(png->is_color);
}

TEST(PngDecoder, LeavesDamagedFilesToOpenImageIo) {
  const std::string whole = png_of(noise(CV_8UC3));
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(decode_png(whole.substr(0, size))) << size;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x20);
    const std::optional<DecodedPng> png = decode_png(damaged);
    EXPECT_FALSE(png) << "byte " << i;
  }
}

TEST(PngDecoder, LeavesOtherKindsToOpenImageIo) {
  const cv::Mat image = noise(CV_8UC1);
  const std::string data = chunk("IDAT", compressed(filtered_rows(image)));
  const std::string end = chunk("IEND", "");
  EXPECT_TRUE(decode_png(kSignature + header(image) + data + end));
  EXPECT_FALSE(decode_png(kSignature + header(image, true) + data + end));                  // interlaced
  EXPECT_FALSE(decode_png(kSignature + header(image) + chunk("tRNS", "ab") + data + end));  // transparent
  EXPECT_FALSE(decode_png(kSignature + header(noise(CV_8UC3)) + data + end));               // too few pixels
  EXPECT_FALSE(
      decode_png(kSignature + header(cv::Mat(kHeight - 1, kWidth, CV_8UC1)) + data + end));  // too many
}

}  // namespace
}  // namespace stillpoint::datasets
