// SPDX-License-Identifier: BSD-3-Clause
/// Encodes JPEG images with libjpeg-turbo: runs write annotated images, for which OpenImageIO is not loaded.
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace stillpoint::datasets {

/// @param image   CV_8UC1 or CV_8UC3 (R, G, B), not empty
/// @param quality 1 to 100
/// @return nullopt if the encoder fails, e.g. for an image of more than 65500 rows
[[nodiscard]] std::optional<std::vector<unsigned char>> encode_jpeg(const cv::Mat& image, int quality);

}  // namespace stillpoint::datasets
