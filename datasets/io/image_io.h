// SPDX-License-Identifier: BSD-3-Clause
/// Reads and writes image files as cv::Mat. Common PNG files are decoded by `decode_png`, JPEG files are
/// written by libjpeg-turbo; all others are left to OpenImageIO, which is loaded when the first one is met.
/// All functions are thread-safe. Error messages name the file.
///
/// `decode_png` takes half the time of libpng: ISA-L decompresses whole buffers. CPU time per image
/// (with libdeflate, which is as fast within 15 %),
/// OpenImageIO / libspng / this decoder / gray only:
///   color 848x480 (rendered)  6.2 / 5.1 / 4.4 / 2.9 ms   depth  3.8 / 3.1 / 1.4 ms
///   color 640x480 (D435)      5.4 / 4.6 / 3.3 / 2.4 ms   depth  3.2 / 3.0 / 1.3 ms
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace stillpoint::datasets {

/// Decodes a gray or color image (PNG, JPEG or any other format of OpenImageIO) of 8 or 16 bits per channel,
/// of which the upper 8 are used.
/// @return CV_8UC1, or CV_8UC3 in the order R, G, B; an alpha channel is dropped
/// @throws InputError if the file is missing, truncated, undecodable, has another bit depth, or more than
/// 2^28 pixels
[[nodiscard]] cv::Mat read_image(const std::filesystem::path& file);

struct GrayImage {
  cv::Mat image;          ///< CV_8UC1
  bool is_color = false;  ///< whether the file is in color
};

/// `to_gray(read_image(file))`, in less time.
/// @throws InputError as `read_image`
[[nodiscard]] GrayImage read_gray(const std::filesystem::path& file);

/// The largest value of a PNG with gray values of 16 bits, which may be brightness or depth.
/// @return nullopt of other files
[[nodiscard]] std::optional<int> largest_deep_gray(const std::filesystem::path& file);

/// Decodes a depth image: one channel of 16 bits, or of floats in meters (TIFF, OpenEXR).
/// @return CV_16UC1, the raw values; CV_32FC1, meters
/// @throws InputError as above
[[nodiscard]] cv::Mat read_depth(const std::filesystem::path& file);

/// Depth of 32-bit floats in 16 bits; values that are not finite, not positive or too far for 16 bits become
/// 0.
/// @param meters CV_32FC1
[[nodiscard]] cv::Mat in_depth_units(const cv::Mat& meters, double units_per_m);

/// Decode the bytes of a PNG or JPEG file, like `read_image` and `read_depth`.
/// @param name of the image, for errors
/// @throws InputError as above
[[nodiscard]] cv::Mat decode_image(std::string_view bytes, const std::string& name);
[[nodiscard]] cv::Mat decode_depth(std::string_view bytes, const std::string& name);

/// What to return for a color image.
enum class PngPixels { kAsStored, kGray };

struct DecodedPng {
  cv::Mat image;          ///< CV_8UC1, CV_8UC3 (R, G, B) or CV_16UC1
  bool is_color = false;  ///< whether the file is in color
};

/// Decodes images without interlacing, transparency or palette, with 8 bits of gray or RGB, or 16 bits of
/// gray.
/// @param bytes the whole file
/// @param pixels `kGray`: RGB is converted as by `to_gray`
/// @return nullopt for all other images and for damaged ones, which OpenImageIO decodes or describes
[[nodiscard]] std::optional<DecodedPng> decode_png(std::string_view bytes,
                                                   PngPixels pixels = PngPixels::kAsStored);

/// Luma of an RGB image by ITU-R BT.601, Y = 0.299 R + 0.587 G + 0.114 B; a gray image is returned unchanged.
/// @param image CV_8UC3 (R, G, B) or CV_8UC1
[[nodiscard]] cv::Mat to_gray(const cv::Mat& image);

/// Names and versions of OpenImageIO and its libraries. Lossy formats may decode differently with others.
/// @throws InputError if OpenImageIO is not installed
[[nodiscard]] std::string image_decoder_version();

/// Writes a PNG, compressed for speed rather than size.
/// @param image CV_8UC1, CV_8UC3 (R, G, B) or CV_16UC1, not empty
/// @throws InputError if the file cannot be written completely; no partial file remains
void write_png(const std::filesystem::path& file, const cv::Mat& image);

/// Writes a JPEG (lossy).
/// @param image CV_8UC1 or CV_8UC3 (R, G, B), not empty
/// @param quality 1 to 100
/// @throws InputError as `write_png`
void write_jpeg(const std::filesystem::path& file, const cv::Mat& image, int quality = 90);

/// The bytes that `write_jpeg` writes.
/// @throws InputError if the image has more than 65500 rows or columns
[[nodiscard]] std::string encode_jpeg(const cv::Mat& image, int quality = 90);

}  // namespace stillpoint::datasets
