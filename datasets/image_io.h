// SPDX-License-Identifier: BSD-3-Clause
/// Pictures on disk to and from cv::Mat. The only file pair that knows OpenImageIO.
///
/// Every function may be called from several threads at once. Each error names the file.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace stillpoint {

/// Decodes a gray or colour picture (PNG, JPEG and whatever else OpenImageIO reads) of 8 bits per channel.
/// @return CV_8UC1, or CV_8UC3 in the order R, G, B; an alpha channel is dropped
/// @throws InputError if the file is missing, truncated, undecodable, or of another number of bits or
/// channels
[[nodiscard]] cv::Mat read_picture(const std::filesystem::path& file);

/// Decodes a depth picture: one channel of 16 bits.
/// @return CV_16UC1, the raw values
/// @throws InputError as above
[[nodiscard]] cv::Mat read_depth(const std::filesystem::path& file);

/// Luma of an RGB picture (ITU-R BT.601 weights, rounded); a gray picture is passed through.
/// @param picture CV_8UC3 (R, G, B) or CV_8UC1
[[nodiscard]] cv::Mat to_gray(const cv::Mat& picture);

/// Writes a PNG, compressed fast rather than well.
/// @param picture CV_8UC1, CV_8UC3 (R, G, B) or CV_16UC1, not empty
/// @throws InputError if the file cannot be written completely; nothing half-written is left behind
void write_png(const std::filesystem::path& file, const cv::Mat& picture);

/// Writes a JPEG: small, and not what was there before to the bit.
/// @param picture CV_8UC1 or CV_8UC3 (R, G, B), not empty
/// @param quality 1 to 100
/// @throws InputError as `write_png`
void write_jpeg(const std::filesystem::path& file, const cv::Mat& picture, int quality = 90);

}  // namespace stillpoint
