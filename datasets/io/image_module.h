// SPDX-License-Identifier: BSD-3-Clause
/// OpenImageIO behind function pointers, in a module of its own (shared_module.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace stillpoint::datasets {

struct LoadedImage {
  /// Gray, or the first three channels; empty if the file has another depth. Floats of one channel are
  /// returned as CV_32F for an expected depth of 16 bits, and colors of 16 bits are reduced to 8.
  cv::Mat pixels;
  int channels = 0;     ///< of the file
  int bits = 0;         ///< per channel of the file
  std::string problem;  ///< why the file cannot be decoded, with the remedy; else empty
};

/// Larger images are refused before memory is taken for them.
inline constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;

struct ImageModule {
  /// @param depth CV_8U or CV_16U: the expected depth
  LoadedImage (*load)(const std::filesystem::path& file, int depth);
  /// The same for the bytes of a PNG or JPEG file.
  LoadedImage (*decode)(std::string_view bytes, int depth);
  /// Names and versions of the libraries that decode images.
  std::string (*version)();
};

}  // namespace stillpoint::datasets
